/* What keeps the energy of a run: steps made again, contact at all shared times, refusals of what is known to be unstable. */
#include <contact/parts.h>
#include <sys/petsccompat.h>

/* Ends with an error where a choice is known to gain energy, unless the user wants it all the same; what: the choice, and what to do */
PetscErrorCode ContactRefuseUnstable(Contact contact, PetscBool unstable, const char what[])
{
  PetscFunctionBegin;
  PetscCheck(!unstable || contact->options.allow_unstable, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "%s; -contact_allow_unstable true lets it run all the same", what);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether contact nodes of a body have mass and can move alone */
PetscBool ContactBodyHasMass(Body body)
{
  return (PetscBool)(!BodyDoes(body, BodyIsRedistributed) && !BodyDoes(body, BodyIsStatic) && !BodyDoes(body, BodyIsRigid));
}

/* Whether a set needs the rule `impulse`: contact nodes that have mass, be it that of a rigid body which meets what cannot yield */
PetscBool ContactNeedsImpulse(Contact contact, PetscInt b)
{
  PetscBool needs = ContactBodyHasMass(contact->bodies[b]);

  for (PetscInt p = 0; p < contact->n_pairs && BodyDoes(contact->bodies[b], BodyIsRigid) && !needs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    if (pair->body[0] != b && pair->body[1] != b) continue;
    needs = pair->obstacle ? PETSC_TRUE : BodyDoes(contact->bodies[pair->body[pair->body[0] == b]], BodyIsRigid);
  }
  return needs;
}

/* Whether a side of any pair (all_sides = false), or both sides of some pair (true), have mass on contact nodes that can move alone */
PetscBool ContactHasMass(Contact contact, PetscBool all_sides)
{
  PetscInt with_mass = 0;

  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair   = &contact->pairs[p];
    const PetscBool    first  = ContactBodyHasMass(contact->bodies[pair->body[0]]);
    const PetscBool    second = pair->obstacle ? all_sides : ContactBodyHasMass(contact->bodies[pair->body[1]]);

    if (all_sides ? first && second : first || second) return PETSC_TRUE;
  }
  for (PetscInt b = 0; b < contact->n_bodies && contact->neighbours.come_and_go; b++) /* any two of them may come near */
    with_mass += ContactBodyHasMass(contact->bodies[b]);
  return (PetscBool)(with_mass > (all_sides && !contact->n_obstacles ? 1 : 0));
}

/* Type and line search of an outer iteration, as options have them: full steps, and this type by default. There is no Jacobian, so neither
   Newton's method nor line searches that want the slope of the residual's norm, which multiply with it. */
PetscErrorCode ContactSetOuterFromOptions(Contact contact, SNES snes, SNESType by_default)
{
  MPI_Comm           comm = PetscObjectComm((PetscObject)contact);
  char               type[64];
  SNESLineSearch     line_search;
  SNESLineSearchType search;
  PetscBool          known, slope;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(type, by_default, sizeof(type)));
  PetscCall(PetscOptionsGetString(NULL, "schwarz_", "-snes_type", type, sizeof(type), NULL));
  PetscCall(PetscStrcmpAny(type, &known, SNESANDERSON, SNESNRICHARDSON, SNESNGMRES, SNESQN, ""));
  PetscCheck(known, comm, PETSC_ERR_USER_INPUT,
             "-schwarz_snes_type %s: the outer iteration has no Jacobian; choose anderson, nrichardson, ngmres or qn", type);
  PetscCall(SNESSetOptionsPrefix(snes, "schwarz_"));
  PetscCall(SNESSetType(snes, type));
  PetscCall(SNESGetLineSearch(snes, &line_search)); /* the type's own, which takes other steps */
  PetscCall(SNESLineSearchSetType(line_search, LINESEARCH_FULL_STEP));
  PetscCall(SNESSetFromOptions(snes));
  PetscCall(SNESLineSearchGetType(line_search, &search));
  PetscCall(PetscStrcmpAny(search, &slope, SNESLINESEARCHBT, SNESLINESEARCHNLEQERR, ""));
  PetscCheck(!slope, comm, PETSC_ERR_USER_INPUT,
             "-schwarz_snes_linesearch_type %s needs products with the Jacobian, which the outer iteration does not have; choose none, "
             "secant or cp",
             search);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where in a substep inertia and forces are in balance: alpha_m and alpha_f of the generalised-alpha method, 1 and 1 for others */
PetscErrorCode ContactGetStage(Body body, PetscReal stage[2])
{
  PetscBool newmark;
  TS        ts;

  PetscFunctionBegin;
  stage[0] = stage[1] = 1;
  PetscCall(BodyGetTS(body, &ts));
  PetscCall(PetscObjectTypeCompare((PetscObject)ts, TSALPHA2, &newmark));
  if (!newmark) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TSAlpha2GetParams(ts, &stage[0], &stage[1], NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Says for which pairs forces act at different times on both bodies, or inside a step on ties prescribed on nodes with mass */
PetscErrorCode ContactWarnOfStages(Contact contact, PetscBool of_ties)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscReal          stage[2][2];
    PetscBool          differ, between;

    if (pair->obstacle) continue;
    for (PetscInt side = 0; side < 2; side++) PetscCall(ContactGetStage(contact->bodies[pair->body[side]], stage[side]));
    differ  = (PetscBool)(stage[0][0] != stage[1][0] || stage[0][1] != stage[1][1]);
    between = (PetscBool)(pair->keeps_mass && !(stage[0][0] == stage[0][1] && (stage[0][0] == 1 || stage[0][0] == 0.5)));
    if (of_ties ? differ || !between : !differ) continue;
    PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)contact), stderr,
                           "impakt: warning: %s: -<body>_ts_alpha_... lets forces act at %s, so that energy and momentum at contact have "
                           "errors of first order in the step; %s\n",
                           pair->name, of_ties ? "times inside a step on tied nodes with mass" : "different times of a step on both bodies",
                           of_ties ? "choose -schwarz_transmission robin, or a radius of 1" : "give both bodies the same parameters"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
