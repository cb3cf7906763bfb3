/* A sum over bytes, by which those that have changed are found out. */
#pragma once
#include <stdint.h>
#include <string.h>

#define BYTE_SUM_BEGIN 0xcbf29ce484222325u

/* FNV-1a (G. Fowler, L. C. Noll, P. Vo) over words of 8 bytes, of which the last one is filled up with zeros */
static inline uint64_t ByteSum(uint64_t sum, size_t size, const void *bytes)
{
  for (size_t i = 0; i < size; i += 8) {
    uint64_t word = 0;

    memcpy(&word, (const char *)bytes + i, size - i < 8 ? size - i : 8);
    sum = (sum ^ word) * 0x100000001b3u;
    sum ^= sum >> 32;
  }
  return sum;
}
