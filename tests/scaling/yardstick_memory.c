/*
   Yardstick for what two cores of a machine can do more than one: bandwidth of memory, by the triad a = b + s c on arrays that are larger
   than a core's share of the caches should be (McCalpin's STREAM). Prints GB/s, the mean over the processor time, so that other programs
   on the core do not count. Two of it at a time share the memory.

     ./yardstick_memory [MB of one array, default 200] [seconds, default 2]
*/
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double Now(clockid_t clock)
{
  struct timespec t;

  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(int argc, char **argv)
{
  const double megabytes = argc > 1 ? atof(argv[1]) : 200, seconds = argc > 2 ? atof(argv[2]) : 2;
  const size_t n = (size_t)(megabytes * 1e6 / sizeof(double));
  double      *a = malloc(n * sizeof(double)), *b = malloc(n * sizeof(double)), *c = malloc(n * sizeof(double));
  const double start  = Now(CLOCK_MONOTONIC);
  double       total  = 0;
  int          passes = 0;

  if (!a || !b || !c || n < 1) {
    fprintf(stderr, "no memory for three arrays of %g MB\n", megabytes);
    return 1;
  }
  for (size_t i = 0; i < n; i++) {
    a[i] = 0;
    b[i] = 1;
    c[i] = (double)i;
  }
  const double begin = Now(CLOCK_PROCESS_CPUTIME_ID);
  do {
    for (size_t i = 0; i < n; i++) a[i] = b[i] + (0.5 + passes) * c[i];
    total += a[n / 2];
    passes++;
  } while (Now(CLOCK_MONOTONIC) - start < seconds);
  printf("{\"GB_per_s\": %.4f, \"passes\": %d, \"check\": %.3e}\n",
         3e-9 * sizeof(double) * (double)n * passes / (Now(CLOCK_PROCESS_CPUTIME_ID) - begin), passes, total);
  free(a);
  free(b);
  free(c);
  return 0;
}
