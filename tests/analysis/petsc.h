/* What cppcheck has to know of PETSc, MPI and CMocka, whose headers it does not read: macros that it would take for functions or types. */
#define PETSC_EXTERN        extern
#define PETSC_INTERN        extern
#define PETSC_STATIC_INLINE static inline
#define PETSC_TRUE          1
#define PETSC_FALSE         0
#define PETSC_SUCCESS       0
#define PetscFunctionBegin
#define PetscFunctionReturn(value) return value
#define PetscCall(call)                                                                                                                    \
  do {                                                                                                                                     \
    const int error_ = (call);                                                                                                             \
    if (error_) return error_;                                                                                                             \
  } while (0)
#define PetscCallMPI(call)        PetscCall(call)
#define PetscCallBLAS(name, call) call
#define PetscCheck(condition, ...)                                                                                                         \
  do {                                                                                                                                     \
    if (!(condition)) return 77;                                                                                                           \
  } while (0)
#define PetscAssert(condition, ...)                 ((void)0)
#define SETERRQ(...)                                return 77
#define PetscValidHeaderSpecific(object, id, place) ((void)0)
#define PetscAssertPointer(pointer, place)          ((void)0)
#define PetscInt_FMT                                "d"
#define PetscInt64_FMT                              "ld"
#define PETSC_VERSION_LT(major, minor, subminor)    0
#define PETSC_VERSION_GE(major, minor, subminor)    1
#define PetscMin(a, b)                              ((a) < (b) ? (a) : (b))
#define PetscMax(a, b)                              ((a) < (b) ? (b) : (a))
