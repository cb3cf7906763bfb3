/* Many small bodies are many small objects, all over the heap: where pages have 4 kB looking up addresses takes as long as the numbers.
   With pages of 2 MB the processor's table of addresses covers most of a step. Linux gives these on request. */
#define _DEFAULT_SOURCE /* madvise() */
#include "largepages.h"
#if defined(__linux__)
#  include <stdint.h>
#  include <stdio.h>
#  include <string.h>
#  include <sys/mman.h>
#  if !defined(MADV_COLLAPSE)
#    define MADV_COLLAPSE 25 /* of Linux 6.1, which glibc knows since 2.38 */
#  endif

#  define PAGE ((uintptr_t)2 << 20)
#endif

/* Puts the heap as it is now on large pages. A hint: where the system does not have them, nothing happens. */
void UseLargePages(void)
{
#if defined(__linux__)
  FILE *maps = fopen("/proc/self/maps", "r");
  char  line[512];

  if (!maps) return;
  while (fgets(line, sizeof(line), maps)) { /* begin-end ... [heap] */
    void *begin, *end;
    char *first, *last;

    if (!strstr(line, "[heap]") || sscanf(line, "%p-%p", &begin, &end) != 2) continue;
    first = (char *)begin + (PAGE - (uintptr_t)begin % PAGE) % PAGE;
    last  = (char *)end - (uintptr_t)end % PAGE;
    if (first < last) (void)madvise(first, (size_t)(last - first), MADV_COLLAPSE);
  }
  (void)fclose(maps);
#endif
}
