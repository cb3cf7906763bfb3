/* Members of the JSON objects of the summary. What cannot be stored (no memory, not UTF-8) is an error, what is no number is null. */
#include "summaryimpl.h"

PetscErrorCode SummarySetMember(json_t *object, const char name[], json_t *value)
{
  PetscFunctionBegin;
  PetscCheck(!json_object_set_new(object, name, value), PETSC_COMM_SELF, PETSC_ERR_LIB,
             "Jansson cannot store '%s' in the summary: out of memory, or not UTF-8", name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SummarySetReal(json_t *object, const char name[], PetscReal value)
{
  PetscFunctionBegin;
  PetscCall(SummarySetMember(object, name, PetscIsInfOrNanReal(value) ? json_null() : json_real((double)value)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SummarySetInteger(json_t *object, const char name[], PetscInt64 value)
{
  PetscFunctionBegin;
  PetscCall(SummarySetMember(object, name, json_integer((json_int_t)value)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SummarySetVector(json_t *object, const char name[], const PetscReal values[3])
{
  json_t *array = json_array();

  PetscFunctionBegin;
  for (PetscInt d = 0; d < 3; d++)
    PetscCheck(!json_array_append_new(array, PetscIsInfOrNanReal(values[d]) ? json_null() : json_real((double)values[d])), PETSC_COMM_SELF,
               PETSC_ERR_LIB, "Jansson cannot store '%s' in the summary: out of memory", name);
  PetscCall(SummarySetMember(object, name, array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a new object as a member; it belongs to its parent */
PetscErrorCode SummarySetObject(json_t *object, const char name[], json_t **member)
{
  PetscFunctionBegin;
  *member = json_object();
  PetscCall(SummarySetMember(object, name, *member));
  PetscFunctionReturn(PETSC_SUCCESS);
}
