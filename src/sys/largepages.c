/*
   Many small bodies are many small objects, all over the heap: where pages have 4 kB the processor looks for their addresses as long as for
   their numbers. Where they have 2 MB its table of addresses covers most of what a step goes through. Linux gives such pages to those alone
   who ask for them.
*/
#define _DEFAULT_SOURCE /* madvise() */
#include "largepages.h"
#if defined(__linux__)
#  include <stdint.h>
#  include <stdio.h>
#  include <stdlib.h>
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
    char     *rest;
    uintptr_t first, last;

    if (!strstr(line, "[heap]")) continue;
    first = ((uintptr_t)strtoull(line, &rest, 16) + PAGE - 1) / PAGE * PAGE;
    if (*rest != '-') continue;
    last = (uintptr_t)strtoull(rest + 1, NULL, 16) / PAGE * PAGE;
    if (first < last) (void)madvise((void *)first, last - first, MADV_COLLAPSE);
  }
  (void)fclose(maps);
#endif
}
