/* Waveforms: values of rows at equally spaced times of a controller step. */
#include <impakt/private/trace.h>
#include <petsc/private/petscimpl.h>

struct _n_Trace {
  PetscInt     size, levels;
  PetscScalar *values; /* (levels + 1) x size, level by level */
};

/* Creates a waveform of zeros. `levels`: number of equal intervals of the controller step, at least 1 */
PetscErrorCode TraceCreate(PetscInt size, PetscInt levels, Trace *trace)
{
  PetscFunctionBegin;
  PetscAssertPointer(trace, 3);
  PetscCheck(levels > 0, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE, "A trace needs at least one interval, not %" PetscInt_FMT, levels);
  PetscCall(PetscNew(trace));
  (*trace)->size   = size;
  (*trace)->levels = levels;
  PetscCall(PetscCalloc1((levels + 1) * size, &(*trace)->values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Frees a waveform */
PetscErrorCode TraceDestroy(Trace *trace)
{
  PetscFunctionBegin;
  if (!*trace) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*trace)->values));
  PetscCall(PetscFree(*trace));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `size`: numbers in a level, or `NULL`; `levels`: number of intervals of the controller step, or `NULL` */
PetscErrorCode TraceGetSizes(Trace trace, PetscInt *size, PetscInt *levels)
{
  PetscFunctionBegin;
  PetscAssertPointer(trace, 1);
  if (size) *size = trace->size;
  if (levels) *levels = trace->levels;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The values at one level, to read or write. `values`: `size` numbers, owned by the trace */
PetscErrorCode TraceGetLevel(Trace trace, PetscInt level, PetscScalar **values)
{
  PetscFunctionBegin;
  PetscAssertPointer(trace, 1);
  PetscAssertPointer(values, 3);
  PetscAssert(level >= 0 && level <= trace->levels, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
              "Level %" PetscInt_FMT " of a trace with %" PetscInt_FMT " intervals", level, trace->levels);
  *values = trace->values + level * trace->size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckRows(Trace trace, PetscInt begin, PetscInt n)
{
  PetscFunctionBegin;
  PetscCheck(n >= 0 && begin >= 0 && begin + n <= trace->size, PETSC_COMM_SELF, PETSC_ERR_ARG_SIZ,
             "%" PetscInt_FMT " rows from number %" PetscInt_FMT " on of a trace with %" PetscInt_FMT " rows", n, begin, trace->size);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Interpolate(Trace trace, PetscReal time, PetscInt begin, PetscInt n, PetscScalar values[])
{
  const PetscReal    position = time * trace->levels;
  const PetscInt     level    = (PetscInt)PetscMin(PetscMax(PetscFloorReal(position), 0), trace->levels - 1);
  const PetscReal    weight   = position - level;
  const PetscScalar *lower = trace->values + level * trace->size + begin, *upper = lower + trace->size;

  /* at both ends of an interval the result is the value there, bit for bit */
  for (PetscInt i = 0; i < n; i++) values[i] = weight == 1 ? upper[i] : lower[i] + weight * (upper[i] - lower[i]);
}

/* The values of some rows at any time of the controller step */
PetscErrorCode TraceInterpolate(Trace trace, PetscReal time, PetscInt begin, PetscInt n, PetscScalar values[])
{
  PetscFunctionBegin;
  PetscAssertPointer(trace, 1);
  PetscCall(CheckRows(trace, begin, n));
  Interpolate(trace, time, begin, n, values);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Evaluates `n` rows of a waveform, from `begin` on, at all levels of another one, where they begin at `to_begin`; scaled */
PetscErrorCode TraceResample(Trace from, PetscInt begin, PetscInt n, PetscScalar scale, Trace to, PetscInt to_begin)
{
  PetscFunctionBegin;
  PetscCall(CheckRows(from, begin, n));
  PetscCall(CheckRows(to, to_begin, n));
  for (PetscInt level = 0; level <= to->levels; level++) {
    PetscScalar *values = to->values + level * to->size + to_begin;

    if (from->levels == to->levels) PetscCall(PetscArraycpy(values, from->values + level * from->size + begin, n));
    else Interpolate(from, (PetscReal)level / to->levels, begin, n, values);
    for (PetscInt i = 0; i < n; i++) values[i] *= scale;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same of a waveform that is constant between its levels, with the value at the end of the interval */
PetscErrorCode TraceResampleConstant(Trace from, PetscInt begin, PetscInt n, PetscScalar scale, Trace to, PetscInt to_begin)
{
  PetscFunctionBegin;
  PetscCall(CheckRows(from, begin, n));
  PetscCall(CheckRows(to, to_begin, n));
  for (PetscInt level = 0; level <= to->levels; level++) {
    /* the level of `from` that is at this time, or the next one after it */
    const PetscScalar *source = from->values + ((level * from->levels + to->levels - 1) / to->levels) * from->size + begin;
    PetscScalar       *values = to->values + level * to->size + to_begin;

    for (PetscInt i = 0; i < n; i++) values[i] = scale * source[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
