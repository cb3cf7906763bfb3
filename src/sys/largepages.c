/*
   Many small bodies are many small objects, all over the heap: looking up their addresses takes as long as their numbers. Where each entry of
   the processor's table of addresses covers 2 MB in place of 4 kB it covers most of what a step goes through. Linux gives such pages to who
   asks for them alone.
*/
#define _DEFAULT_SOURCE /* madvise() */
#include "largepages.h"
#include <petscsys.h>
#if defined(__linux__)
#  include <stdint.h>
#  include <stdio.h>
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
  FILE         *maps = fopen("/proc/self/maps", "r");
  char          line[512];
  unsigned long begin, end;

  if (!maps) return;
  while (fgets(line, sizeof(line), maps)) {
    uintptr_t first, last;

    if (!strstr(line, "[heap]") || sscanf(line, "%lx-%lx", &begin, &end) != 2) continue;
    first = (begin + PAGE - 1) / PAGE * PAGE;
    last  = end / PAGE * PAGE;
    if (first < last) (void)madvise((void *)first, last - first, MADV_COLLAPSE);
  }
  (void)fclose(maps);
#endif
}
