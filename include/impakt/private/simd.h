/* Loops over batches of points or elements, laid out as structures of arrays so that one instruction serves a whole batch. */
#pragma once
#include <petscsystypes.h>

/* Elements or points in a batch: one AVX-512 register of doubles, two AVX2 ones */
#define SIMD_WIDTH 8

/* A function with SIMD_CLONES before it is compiled for several generations of processors; the program loader picks one. What it
   calls should be inlined (SIMD_INLINE), or it is compiled for the oldest. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__)
#  define SIMD_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#  define SIMD_CLONES
#endif
#if defined(__GNUC__)
#  define SIMD_INLINE static inline __attribute__((always_inline))
#else
#  define SIMD_INLINE static inline
#endif

/* One number for each member of a batch */
typedef PetscReal SimdReal[SIMD_WIDTH] __attribute__((aligned(64)));

/* Part of it as one value that can be calculated with, GCC's and Clang's vectors: where loops over the members are too long for compilers
   to vectorise. Half a batch, since vectors wider than the registers compiled for are kept in memory, each operation of its own: on
   processors with AVX2 whole batches took 3.5 times as long. Not to be passed or returned by value but where inlined: how depends on the
   processor compiled for. */
#define SIMD_PARTS 2
typedef PetscReal SimdVector __attribute__((vector_size(SIMD_WIDTH / SIMD_PARTS * sizeof(PetscReal)), may_alias));

/* The parts of one number of a batch, or of several */
SIMD_INLINE SimdVector *SimdGetParts(PetscReal values[])
{
  return (SimdVector *)values;
}
