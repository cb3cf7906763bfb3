/* Replaces the allocators of the C library and of PETSc by ones that count, in the program that includes this. What PETSc takes for the
   factors of a dense matrix, and in each solution with them, does not count: a law of rows with other states has other factors. */
#pragma once
#include <petscsys.h>
#include <string.h>

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void *__libc_memalign(size_t, size_t);

static volatile long allocations, petsc_allocations;

#if !defined(__SANITIZE_ADDRESS__)
void *malloc(size_t size)
{
  allocations++;
  return __libc_malloc(size);
}

void *calloc(size_t n, size_t size)
{
  allocations++;
  return __libc_calloc(n, size);
}

void *realloc(void *old, size_t size)
{
  allocations++;
  return __libc_realloc(old, size);
}

int posix_memalign(void **memory, size_t alignment, size_t size)
{
  allocations++;
  *memory = __libc_memalign(alignment, size);
  return *memory ? 0 : 12;
}
#endif

static PetscErrorCode (*petsc_allocate)(size_t, PetscBool, int, const char[], const char[], void **);
static PetscErrorCode (*petsc_reallocate)(size_t, int, const char[], const char[], void **);

static PetscErrorCode CountAllocate(size_t size, PetscBool clear, int line, const char function[], const char file[], void **memory)
{
  static const char *const of_factors[] = {"PetscFPTrapPush", "PetscStrallocpy", "MatSeqDenseSetPreallocation_SeqDense"};
  const long               before       = allocations;
  PetscErrorCode           error        = (*petsc_allocate)(size, clear, line, function, file, memory);

  petsc_allocations++;
  for (size_t k = 0; k < sizeof(of_factors) / sizeof(of_factors[0]); k++)
    if (!strcmp(function, of_factors[k])) {
      petsc_allocations--;
      allocations = before;
    }
  return error;
}

static PetscErrorCode CountReallocate(size_t size, int line, const char function[], const char file[], void **memory)
{
  petsc_allocations++;
  return (*petsc_reallocate)(size, line, function, file, memory);
}

/* Once PETSc has been initialised. PetscMallocSet() must not be called where an option has set another allocator. */
static inline void count_petsc_allocations(PetscBool count)
{
  if (count) {
    petsc_allocate   = PetscTrMalloc;
    petsc_reallocate = PetscTrRealloc;
  }
  PetscTrMalloc  = count ? CountAllocate : petsc_allocate;
  PetscTrRealloc = count ? CountReallocate : petsc_reallocate;
}
