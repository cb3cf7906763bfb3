/* Waveforms: values of rows at equally spaced times of a controller step. */
#include <impakt/trace.h>
#include <petsc/private/petscimpl.h>

struct _n_Trace {
  PetscInt     size, levels;
  PetscScalar *values; /* (levels + 1) x size, level by level */
};

/*@
  TraceCreate - creates a waveform of zeros

  Not Collective

  Input Parameters:
+ size   - how many numbers each level holds (contact rows of this rank)
- levels - number of equal intervals of the controller step, at least 1

  Output Parameter:
. trace - the waveform

  Level: developer

.seealso: `Trace`, `TraceDestroy()`
@*/
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

/*@
  TraceDestroy - frees a waveform

  Not Collective

  Input Parameter:
. trace - the waveform, set to `NULL`

  Level: developer

.seealso: `Trace`, `TraceCreate()`
@*/
PetscErrorCode TraceDestroy(Trace *trace)
{
  PetscFunctionBegin;
  if (!*trace) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*trace)->values));
  PetscCall(PetscFree(*trace));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TraceGetSizes - how many numbers a level holds, and how many intervals the controller step has

  Not Collective

  Input Parameter:
. trace - the waveform

  Output Parameters:
+ size   - numbers in a level, or `NULL`
- levels - number of intervals, or `NULL`

  Level: developer

.seealso: `Trace`
@*/
PetscErrorCode TraceGetSizes(Trace trace, PetscInt *size, PetscInt *levels)
{
  PetscFunctionBegin;
  PetscAssertPointer(trace, 1);
  if (size) *size = trace->size;
  if (levels) *levels = trace->levels;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TraceZero - sets all levels to zero

  Not Collective

  Input Parameter:
. trace - the waveform

  Level: developer

.seealso: `Trace`
@*/
PetscErrorCode TraceZero(Trace trace)
{
  PetscFunctionBegin;
  PetscAssertPointer(trace, 1);
  PetscCall(PetscArrayzero(trace->values, (trace->levels + 1) * trace->size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TraceGetLevel - the values at one level, to read or write

  Not Collective

  Input Parameters:
+ trace - the waveform
- level - 0 (start of the controller step) to `levels` (its end)

  Output Parameter:
. values - `size` numbers, owned by the trace

  Level: developer

.seealso: `Trace`, `TraceInterpolate()`
@*/
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

/*@
  TraceInterpolate - the values of some rows at any time of the controller step

  Not Collective

  Input Parameters:
+ trace - the waveform
. time  - 0 (start of the controller step) to 1 (its end)
. begin - first row
- n     - number of rows

  Output Parameter:
. values - `n` numbers

  Level: developer

.seealso: `Trace`, `TraceResample()`
@*/
PetscErrorCode TraceInterpolate(Trace trace, PetscReal time, PetscInt begin, PetscInt n, PetscScalar values[])
{
  PetscFunctionBegin;
  PetscAssertPointer(trace, 1);
  PetscCall(CheckRows(trace, begin, n));
  Interpolate(trace, time, begin, n, values);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TraceResample - evaluates some rows of a waveform at the levels of another one, scaled

  Not Collective

  Input Parameters:
+ from     - the waveform to evaluate
. begin    - first row of it
. n        - number of rows
. scale    - factor on the values
. to       - waveform whose rows `to_begin` to `to_begin` + `n` - 1 are set at all its levels
- to_begin - first row of that

  Level: developer

.seealso: `Trace`, `TraceInterpolate()`
@*/
PetscErrorCode TraceResample(Trace from, PetscInt begin, PetscInt n, PetscScalar scale, Trace to, PetscInt to_begin)
{
  PetscFunctionBegin;
  PetscCall(CheckRows(from, begin, n));
  PetscCall(CheckRows(to, to_begin, n));
  for (PetscInt level = 0; level <= to->levels; level++) {
    PetscScalar *values = to->values + level * to->size + to_begin;

    if (from->levels == to->levels) {
      const PetscScalar *source = from->values + level * from->size + begin;

      for (PetscInt i = 0; i < n; i++) values[i] = source[i];
    } else Interpolate(from, (PetscReal)level / to->levels, begin, n, values);
    if (scale != 1)
      for (PetscInt i = 0; i < n; i++) values[i] *= scale;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TraceResampleConstant - as `TraceResample()`, of a waveform that is constant between its levels, with the value at the end of the interval

  Not Collective

  Input Parameters:
+ from     - the waveform to evaluate
. begin    - first row of it
. n        - number of rows
. scale    - factor on the values
. to       - waveform whose rows `to_begin` to `to_begin` + `n` - 1 are set at all its levels
- to_begin - first row of that

  Level: developer

.seealso: `Trace`, `TraceResample()`
@*/
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
