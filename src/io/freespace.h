/* Room on the disk. Private to src/io. */
#pragma once
#include <petscsys.h>

PETSC_INTERN double OutputFreeSpace(const char[]);
