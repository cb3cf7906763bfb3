/* Numbers of Gmsh's files, text or binary. Nothing is read beyond the end of the file. */
#include "gmshimpl.h"

/* The present place in the file, for messages: a line, or in binary files a byte */
const char *GmshWhere(const Gmsh *gmsh, char text[64])
{
  PetscInt line = 1;

  for (const char *c = gmsh->begin; c < gmsh->at; c++) line += *c == '\n';
  if (gmsh->binary) (void)snprintf(text, 64, "byte %ld", (long)(gmsh->at - gmsh->begin));
  else (void)snprintf(text, 64, "line %ld", (long)line);
  return text;
}

void GmshSkipSpace(Gmsh *gmsh)
{
  while (gmsh->at < gmsh->end && (*gmsh->at == ' ' || (*gmsh->at >= '\t' && *gmsh->at <= '\r'))) gmsh->at++;
}

/* Reads numbers that are text. The file's text ends with a 0 byte, so that no number runs beyond its end. */
PetscErrorCode GmshReadText(Gmsh *gmsh, PetscInt n, PetscInt64 values[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) {
    char *after;

    GmshSkipSpace(gmsh); /* so that messages tell the place of the number itself */
    values[i] = strtoll(gmsh->at, &after, 10);
    GmshCheck(gmsh, after != gmsh->at,
              gmsh->at == gmsh->end ? "the file ends within its data: it is cut short" : "a whole number is expected");
    gmsh->at = after;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GmshReadBytes(Gmsh *gmsh, size_t size, PetscInt n, void *values)
{
  PetscFunctionBegin;
  GmshCheck(gmsh, (size_t)(gmsh->end - gmsh->at) / size >= (size_t)n, "the file ends within its data: it is cut short");
  PetscCall(PetscMemcpy(values, gmsh->at, size * (size_t)n));
  gmsh->at += size * (size_t)n;
  if (gmsh->swapped)
    for (PetscInt i = 0; i < n; i++)
      for (size_t b = 0; b < size / 2; b++) {
        char      *bytes = (char *)values + size * (size_t)i;
        const char byte  = bytes[b];

        bytes[b]            = bytes[size - 1 - b];
        bytes[size - 1 - b] = byte;
      }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GmshReadInts(Gmsh *gmsh, PetscInt n, PetscInt64 values[])
{
  PetscFunctionBegin;
  if (gmsh->binary) {
    for (PetscInt i = 0; i < n; i++) {
      int32_t value;

      PetscCall(GmshReadBytes(gmsh, sizeof(value), 1, &value));
      values[i] = value;
    }
  } else PetscCall(GmshReadText(gmsh, n, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads numbers that version 4.1 of the format calls size_t */
PetscErrorCode GmshReadWords(Gmsh *gmsh, PetscInt n, PetscInt64 values[])
{
  PetscFunctionBegin;
  if (gmsh->binary && gmsh->word == 8) PetscCall(GmshReadBytes(gmsh, 8, n, values));
  else PetscCall(GmshReadInts(gmsh, n, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GmshReadReals(Gmsh *gmsh, PetscInt n, double values[])
{
  PetscFunctionBegin;
  if (gmsh->binary) PetscCall(GmshReadBytes(gmsh, sizeof(double), n, values));
  else
    for (PetscInt i = 0; i < n; i++) {
      char *after;

      GmshSkipSpace(gmsh);
      values[i] = strtod(gmsh->at, &after);
      GmshCheck(gmsh, after != gmsh->at, gmsh->at == gmsh->end ? "the file ends within its data: it is cut short" : "a number is expected");
      gmsh->at = after;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks a count of items of at least so many bytes: the rest of the file must have room for them */
PetscErrorCode GmshCheckCount(Gmsh *gmsh, const char what[], PetscInt64 count, PetscInt64 bytes, PetscInt *n)
{
  PetscFunctionBegin;
  GmshCheck(gmsh, count >= 0 && count <= (gmsh->end - gmsh->at) / bytes,
            "%" PetscInt64_FMT " %s cannot be in the rest of the file, which has %ld bytes: a wrong number, or the file is cut short",
            count, what, (long)(gmsh->end - gmsh->at));
  GmshCheck(gmsh, count < PETSC_INT_MAX / 8, "%" PetscInt64_FMT " %s are too many", count, what);
  *n = (PetscInt)count;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads a count of version 2.2: it is text even in binary files, and the data begin after the end of its line */
PetscErrorCode GmshReadCount(Gmsh *gmsh, const char what[], PetscInt64 bytes, PetscInt *n)
{
  PetscInt64 count;

  PetscFunctionBegin;
  PetscCall(GmshReadText(gmsh, 1, &count));
  while (gmsh->at < gmsh->end && *gmsh->at != '\n') gmsh->at++;
  if (gmsh->at < gmsh->end) gmsh->at++;
  PetscCall(GmshCheckCount(gmsh, what, count, bytes, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GmshCheckNumber(Gmsh *gmsh, PetscInt64 value, PetscInt *number)
{
  PetscFunctionBegin;
  *number = -1;
  GmshCheck(gmsh, value >= 0 && value < PETSC_INT_MAX, "%" PetscInt64_FMT " is no number of a node, an element or a group", value);
  *number = (PetscInt)value;
  PetscFunctionReturn(PETSC_SUCCESS);
}
