/* Glue: which law of it pairs have, and its parameters: of all pairs, or of one. */
#include "glue.h"
#include <sys/optionvalues.h>

PetscErrorCode ContactFindGlue(Contact contact, const char name[], PetscInt *glue)
{
  ContactGlue *found;

  PetscFunctionBegin;
  for (*glue = 0; *glue < contact->n_glues; (*glue)++) {
    PetscBool same;

    PetscCall(PetscStrcmp(contact->glues[*glue].name, name, &same));
    if (same) PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscRealloc((size_t)(contact->n_glues + 1) * sizeof(ContactGlue), &contact->glues));
  found = &contact->glues[contact->n_glues];
  PetscCall(RowLawCreate(name, &found->law));
  PetscCheck(found->law.stiffness, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "The law '%s' is no glue: it has no stiffness; choose it by ContactSetLaw()", name);
  PetscCall(PetscStrncpy(found->name, name, sizeof(found->name)));
  for (PetscInt k = 0; k < ROW_LAW_PARAMETERS; k++) found->parameters[k] = -1;
  contact->n_glues++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetGlueLaw - glues the surfaces of all pairs that have no law of their own

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
- name    - a law of glue, as spring

  Options Database Key:
. -contact_law name - the law

  Level: beginner

.seealso: `Contact`, `ContactSetLaw()`, `ContactSetPairGlueLaw()`, `ContactSetGlueParameter()`
@*/
PetscErrorCode ContactSetGlueLaw(Contact contact, const char name[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(name, 2);
  ContactCheckNotSetUp(contact);
  PetscCall(ContactFindGlue(contact, name, &contact->options.glue));
  ContactSpreadLaw(contact, CONTACT_LAW_GLUE);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetPairGlueLaw - glues the surfaces of a pair

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
. pair    - 0 to the number of pairs - 1
- name    - a law of glue, as spring

  Options Database Key:
. -contact_law_<pair> name - the law of the pair, which is named as in -contact_pairs

  Level: intermediate

.seealso: `Contact`, `ContactSetPairLaw()`, `ContactSetGlueLaw()`, `ContactSetPairGlueParameter()`
@*/
PetscErrorCode ContactSetPairGlueLaw(Contact contact, PetscInt pair, const char name[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(name, 3);
  ContactCheckNotSetUp(contact);
  ContactCheckPair(contact, pair);
  PetscCall(ContactFindGlue(contact, name, &contact->pairs[pair].glue));
  contact->pairs[pair].law     = CONTACT_LAW_GLUE;
  contact->pairs[pair].own_law = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number of a parameter of a law, whose value is checked; `of`: nothing, or the name of a pair behind an underscore */
static PetscErrorCode FindParameter(Contact contact, PetscInt glue, const char name[], PetscReal value, const char of[], PetscInt *k)
{
  const MPI_Comm     comm = PetscObjectComm((PetscObject)contact);
  const ContactGlue *law  = &contact->glues[glue];
  PetscBool          same = PETSC_FALSE;

  PetscFunctionBegin;
  for (*k = 0; *k < law->law.n_parameters; (*k)++) {
    PetscCall(PetscStrcmp(law->law.parameters[*k].name, name, &same));
    if (same) break;
  }
  PetscCheck(same, comm, PETSC_ERR_ARG_OUTOFRANGE, "-contact_law %s has no parameter '%s'", law->name, name);
  PetscCheck(value > 0 && value < PETSC_INFINITY, comm, PETSC_ERR_ARG_OUTOFRANGE,
             "-contact_%s_%s%s %g%s must be positive, and finite; leave the glue out, or take -contact_law tied, which is rigid", law->name,
             name, of, (double)value, UnitsOf((PetscObject)contact, law->law.parameters[*k].unit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetGlueParameter - sets a parameter of a law of glue, for all pairs that have none of their own

  Logically Collective

  Input Parameters:
+ contact   - the `Contact`, not yet set up
. law       - name of the law, as spring
. parameter - name of the parameter, as stiffness
- value     - positive, in the unit that the law says

  Options Database Key:
. -contact_<law>_<parameter> x - as -contact_spring_stiffness k [N/m^3]

  Level: intermediate

.seealso: `Contact`, `ContactSetGlueLaw()`, `ContactSetPairGlueParameter()`
@*/
PetscErrorCode ContactSetGlueParameter(Contact contact, const char law[], const char parameter[], PetscReal value)
{
  PetscInt glue, k;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(law, 2);
  PetscAssertPointer(parameter, 3);
  PetscValidLogicalCollectiveReal(contact, value, 4);
  ContactCheckNotSetUp(contact);
  PetscCall(ContactFindGlue(contact, law, &glue));
  PetscCall(FindParameter(contact, glue, parameter, value, "", &k));
  contact->glues[glue].parameters[k] = value;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetPairGlueParameter - gives the glue of a pair a parameter of its own

  Logically Collective

  Input Parameters:
+ contact   - the `Contact`, not yet set up
. pair      - 0 to the number of pairs - 1, of a pair that has a law of glue
. parameter - name of a parameter of that, as stiffness
- value     - positive, in the unit that the law says

  Options Database Key:
. -contact_<law>_<parameter>_<pair> x - the parameter of the pair, which is named as in -contact_pairs

  Level: intermediate

.seealso: `Contact`, `ContactSetPairGlueLaw()`, `ContactSetGlueParameter()`
@*/
PetscErrorCode ContactSetPairGlueParameter(Contact contact, PetscInt pair, const char parameter[], PetscReal value)
{
  char     of[PETSC_MAX_PATH_LEN];
  PetscInt k;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(parameter, 3);
  PetscValidLogicalCollectiveReal(contact, value, 4);
  ContactCheckNotSetUp(contact);
  ContactCheckPair(contact, pair);
  PetscCheck(contact->pairs[pair].law == CONTACT_LAW_GLUE, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_WRONGSTATE,
             "Pair %s is not glued: call ContactSetPairGlueLaw() first", contact->pairs[pair].name);
  PetscCall(PetscSNPrintf(of, sizeof(of), "_%s", contact->pairs[pair].name));
  PetscCall(FindParameter(contact, contact->pairs[pair].glue, parameter, value, of, &k));
  contact->pairs[pair].glue_parameters[k] = value;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGlueBreaks - whether any pair is glued by a law with damage

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. breaks - whether glue may take energy by damage, which `ContactGetCounts()` has

  Level: intermediate

.seealso: `Contact`, `ContactSetGlueLaw()`, `ContactCounts`
@*/
PetscErrorCode ContactGlueBreaks(Contact contact, PetscBool *breaks)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(breaks, 2);
  *breaks = PETSC_FALSE;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (contact->pairs[p].law == CONTACT_LAW_GLUE && contact->glues[contact->pairs[p].glue].law.n_history) *breaks = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The parameters of a pair; less than 0: not set */
void ContactGetGlueParameters(Contact contact, PetscInt p, PetscReal parameters[])
{
  const ContactPair *pair = &contact->pairs[p];

  for (PetscInt k = 0; k < ROW_LAW_PARAMETERS; k++)
    parameters[k] = pair->glue_parameters[k] > 0 ? pair->glue_parameters[k] : contact->glues[pair->glue].parameters[k];
}

/* Parameters of a law from the options, of all pairs and of each that has it */
static PetscErrorCode ReadParameters(Contact contact, PetscInt g)
{
  const ContactGlue *glue = &contact->glues[g];
  PetscBool          set;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)contact);
  for (PetscInt k = 0; k < glue->law.n_parameters; k++) {
    const char *name = glue->law.parameters[k].name, *what = glue->law.parameters[k].what;
    char        option[PETSC_MAX_PATH_LEN];
    PetscReal   value = glue->parameters[k];

    PetscCall(PetscSNPrintf(option, sizeof(option), "-contact_%s_%s", glue->name, name));
    PetscCall(PetscOptionsReal(option, what, "ContactSetGlueParameter", value, &value, &set));
    if (set) PetscCall(ContactSetGlueParameter(contact, glue->name, name, value));
    for (PetscInt p = 0; p < contact->n_pairs; p++) {
      if (contact->pairs[p].law != CONTACT_LAW_GLUE || contact->pairs[p].glue != g) continue;
      PetscCall(PetscSNPrintf(option, sizeof(option), "-contact_%s_%s_%s", glue->name, name, contact->pairs[p].name));
      PetscCall(PetscOptionsReal(option, what, "ContactSetPairGlueParameter", value, &value, &set));
      if (set) PetscCall(ContactSetPairGlueParameter(contact, p, name, value));
    }
  }
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same of all laws, once the pairs and their laws are known: an option that stays unread is an error */
PetscErrorCode ContactReadGlue(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt g = 0; g < contact->n_glues; g++) {
    PetscBool used = (PetscBool)(contact->options.law == CONTACT_LAW_GLUE && contact->options.glue == g);

    for (PetscInt p = 0; p < contact->n_pairs; p++)
      used = (PetscBool)(used || (contact->pairs[p].law == CONTACT_LAW_GLUE && contact->pairs[p].glue == g));
    if (used) PetscCall(ReadParameters(contact, g));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the glue of each pair has its parameters, and these go together */
PetscErrorCode ContactCheckGlue(Contact contact)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)contact);

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const ContactGlue *glue = &contact->glues[pair->glue];
    PetscReal          parameters[ROW_LAW_PARAMETERS];
    const char        *wrong = NULL;

    if (pair->law != CONTACT_LAW_GLUE) continue;
    ContactGetGlueParameters(contact, p, parameters);
    for (PetscInt k = 0; k < glue->law.n_parameters; k++) {
      const RowLawParameter *parameter = &glue->law.parameters[k];
      const char            *name = parameter->name, *unit = UnitsOf((PetscObject)contact, parameter->unit);

      PetscCheck(parameters[k] > 0, comm, PETSC_ERR_USER_INPUT,
                 "-contact_law %s needs the %s of the glue of the pair %s%s%s: set -contact_%s_%s x for all pairs, or "
                 "-contact_%s_%s_%s x for this one%s%s",
                 glue->name, name, pair->name, unit[0] ? ", in" : "", unit, glue->name, name, glue->name, name, pair->name,
                 parameter->hint ? "; " : "", parameter->hint ? parameter->hint : "");
    }
    if (glue->law.check) wrong = (*glue->law.check)(parameters);
    PetscCheck(!wrong, comm, PETSC_ERR_USER_INPUT, "-contact_law %s of the pair %s: %s", glue->name, pair->name, wrong);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
