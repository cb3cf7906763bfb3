/* Exponential and logarithm of half a batch of numbers, to two units in the last place: calls of the library for one number at a time would
 * take most of a material's time. */
#pragma once
#include <impakt/private/simd.h>
#include <stdint.h>

/* All of it is inlined: how vectors would be returned does not matter */
#if defined(__GNUC__) && !defined(__clang__)
#  pragma GCC diagnostic ignored "-Wpsabi"
#endif

/* Beyond, e^x or its inverse is no normal number any more */
#define SIMD_LARGEST_EXPONENT 708

/* The bits of numbers; of a comparison, all of them where it holds */
typedef int64_t SimdBits __attribute__((vector_size(SIMD_WIDTH / SIMD_PARTS * sizeof(PetscReal)), may_alias));

/* By hand, since compilers do not take apart loops with branches whose comparisons may raise exceptions */
SIMD_INLINE SimdVector SimdSelect(SimdBits where, SimdVector there, SimdVector elsewhere)
{
  return (SimdVector)((where & (SimdBits)there) | (~where & (SimdBits)elsewhere));
}

SIMD_INLINE SimdVector SimdAll(PetscReal number)
{
  return (SimdVector){0} + number;
}

SIMD_INLINE SimdVector SimdMin(SimdVector a, SimdVector b)
{
  return SimdSelect((SimdBits)(a < b), a, b);
}

SIMD_INLINE SimdVector SimdMax(SimdVector a, SimdVector b)
{
  return SimdSelect((SimdBits)(a > b), a, b);
}

/* e^x = 2^k e^r with |r| <= ln(2) / 2, by Taylor's series (the next term is 2e-17); x from -708 to 708, numbers beyond as if they were
 * there */
SIMD_INLINE SimdVector SimdExp(SimdVector x)
{
  const PetscReal  shift  = 6755399441055744.; /* 1.5 2^52: a sum with it is rounded to a whole number, which is in its last bits */
  const SimdVector inside = SimdMax(SimdMin(x, SimdAll(SIMD_LARGEST_EXPONENT)), SimdAll(-SIMD_LARGEST_EXPONENT));
  const SimdVector k = inside * 1.4426950408889634 + shift, whole = k - shift;
  const SimdVector r      = (inside - whole * 0.693147180369123816490) - whole * 1.90821492927058770002e-10; /* ln 2 in two parts */
  const SimdVector square = r * r;
  SimdVector       even = SimdAll(1. / 479001600), odd = SimdAll(1. / 6227020800), sum;

  /* of the factors of r^2 on, those of even and of odd powers: two chains of half the length, neither of which waits for the other */
  even = even * square + 1. / 3628800;
  odd  = odd * square + 1. / 39916800;
  even = even * square + 1. / 40320;
  odd  = odd * square + 1. / 362880;
  even = even * square + 1. / 720;
  odd  = odd * square + 1. / 5040;
  even = even * square + 1. / 24;
  odd  = odd * square + 1. / 120;
  even = even * square + 0.5;
  odd  = odd * square + 1. / 6;
  sum  = (even + r * odd) * square + r + 1;
  return sum * (SimdVector)(((SimdBits)k + 1023) << 52);
}

/* ln x = e ln 2 + 2 artanh z with x = 2^e (1 + z) / (1 - z) (Abramowitz and Stegun, 4.1.27; z^2 <= 0.0295, the next term is 6e-19); x
 * positive and normal */
SIMD_INLINE SimdVector SimdLog(SimdVector x)
{
  const SimdBits   bits     = (SimdBits)x;
  const SimdVector exponent = (SimdVector)((bits >> 52) | 0x4330000000000000),
                   mantissa = (SimdVector)((bits & 0x000fffffffffffff) | 0x3ff0000000000000);
  const SimdVector half = SimdSelect((SimdBits)(mantissa > 1.4142135623730951), SimdAll(0.5), SimdAll(1)); /* so that it lies around 1 */
  const SimdVector e    = exponent - (4503599627370496. + 1023) + 2 * (1 - half);
  const SimdVector m = mantissa * half, z = (m - 1) / (m + 1), y = z * z;
  const SimdVector square = y * y;
  SimdVector       even = SimdAll(1. / 19), odd = SimdAll(1. / 21), sum;

  even = even * square + 1. / 15;
  odd  = odd * square + 1. / 17;
  even = even * square + 1. / 11;
  odd  = odd * square + 1. / 13;
  even = even * square + 1. / 7;
  odd  = odd * square + 1. / 9;
  even = even * square + 1. / 3;
  odd  = odd * square + 1. / 5;
  sum  = even + y * odd;
  return e * 0.693147180369123816490 + (e * 1.90821492927058770002e-10 + 2 * (z + z * y * sum));
}
