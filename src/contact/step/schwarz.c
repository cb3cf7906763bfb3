/* The contact type `schwarz`: the contact step, its rule and law. */
#include "stepimpl.h"
#include <checkpoint/checkpoint.h>
#include <sys/citations.h>
#include <sys/units.h>
#include <stddef.h>
#include <impakt/private/bodymass.h>

/* Default tolerances of the outer iteration, of the way that rows go by contact: forces are as right */
#define RTOL       1e-7
#define RTOL_EXACT 1e-9 /* linear bodies, of which S tells right; and static ones: without inertia the balance is what is wanted */
/* What rows read is right to so much, as positions are round-off, in parts of the size of the smallest body */
#define RESOLUTION 2e-15
/* Springs of bodies that contact alone holds find their rest from how the step changes with them, so that it has to be right to round-off:
   with the other tolerances linear stacks took 32 passes for 18. For nonlinear bodies each digit is a pass. */
#define RTOL_FLOATING 1e-13
#define ATOL_FLOATING 0.1 /* of what rows read is right to */
/* Turn of an obstacle's normal above which a row is laid again [rad], as rows between bodies are, see pairsupdate.c */
#define STILL 1e-6

static PetscErrorCode SetFromOptions(Contact contact)
{
  const char *const rules[] = {"auto", "impulse", "linear"};
  PetscInt          rule    = 0;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsEList("-contact_rule", "How forces run within a step", "ContactSetType", rules, 3, rules[0], &rule, NULL));
  PetscOptionsEnd();
  PetscCall(ContactReadUnconverged(contact));
  PetscCall(ContactStepperSetFromOptions(contact));
  Stepper(contact)->asked    = rule == 1 ? &ContactRuleImpulse : rule == 2 ? &ContactRuleLinear : NULL;
  contact->options.keep_mass = (PetscBool)(rule == 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactStepperSetUp - what a step needs of the rows there are; options have been read */
PetscErrorCode ContactStepperSetUp(Contact contact)
{
  ContactStepper *stepper    = Stepper(contact);
  const PetscInt  n          = contact->n_bodies;
  PetscBool       any_static = PETSC_FALSE, all_linear = PETSC_TRUE, floating;

  PetscFunctionBegin;
  PetscCall(ImpaktCite(CITE_SCHWARZ));
  if (contact->dim == 1) PetscCall(ContactRefuseFriction(contact, "bars of one dimension cannot slide; choose frictionless"));
  floating = (PetscBool)(contact->floating.n > 0);
  for (PetscInt k = 0; k < contact->floating.n; k++) floating = (PetscBool)(floating && contact->floating.bodies[k].state.linear);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    any_static = (PetscBool)(any_static || BodyDoes(contact->bodies[b], BodyIsStatic));
    all_linear = (PetscBool)(all_linear && BodyDoes(contact->bodies[b], BodyIsLinear));
  }
  PetscCall(PetscCalloc7(n, &stepper->rules, n, &stepper->group, n, &stepper->moves, n, &stepper->rests, n, &stepper->done, n,
                         &stepper->scale, n, &stepper->off));
  stepper->assembly.of_state = -1;
  PetscCall(ContactStepperCreateVecs(contact, stepper));
  PetscCall(ContactStepperSetUpRules(contact, stepper));
  contact->rows.lists = PETSC_TRUE;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactLaw law  = contact->pairs[p].law;
    const PetscBool  ties = (PetscBool)(law == CONTACT_LAW_TIED || law == CONTACT_LAW_BONDED);

    stepper->laws[p] = law == CONTACT_LAW_GLUE ? RowLaws[contact->pairs[p].named] : ties ? &RowLawTie : &RowLawHold;
    if (law != CONTACT_LAW_FRICTION && law != CONTACT_LAW_FRICTIONLESS) contact->rows.lists = PETSC_FALSE;
  }
  PetscCall(ContactStepperSetUpGlue(contact, stepper));
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    if (stepper->rules[b] != &ContactRuleImpulse) contact->rows.lists = PETSC_FALSE;
  contact->ties.by_mean       = (PetscBool)(contact->impulses && ContactAllPairsTie(contact) && contact->options.shared_times);
  stepper->rtol               = floating ? RTOL_FLOATING : any_static || all_linear ? RTOL_EXACT : RTOL;
  stepper->atol               = (floating ? ATOL_FLOATING : 1) * RESOLUTION * contact->scale.length;
  stepper->assembled          = -1;
  stepper->problem.resolution = RESOLUTION * contact->scale.length;
  PetscCall(LawProblemSetUp(&stepper->problem)); /* options are read now: one that stays unread is an error */
  PetscCall(ContactStepperCreateOuter(contact, stepper));
  PetscCall(SNESGetTolerances(stepper->outer, NULL, &stepper->problem.rtol, NULL, NULL, NULL));
  PetscCall(ContactStepperSetUpTurns(contact, stepper));
  PetscCall(ContactStepperSetUpSprings(contact, stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that a rule lays ahead follow curved obstacles from step to step: ContactLayAhead() is not for them */
static PetscErrorCode LayRows(Contact contact)
{
  const ContactStepper *stepper = Stepper(contact);

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies && stepper->rules; b++) {
    Vec u;

    contact->ahead[b] = stepper->rules[b]->ahead * contact->step;
    PetscCall(BodyGetSolution(contact->bodies[b], &u, NULL, NULL));
    if (contact->ahead[b] != 0 && !contact->ends[b]) PetscCall(VecDuplicate(u, &contact->ends[b])); /* collective: here, on all ranks */
  }
  for (PetscInt p = 0; p < contact->n_pairs && stepper->rules; p++)
    if (contact->pairs[p].obstacle && contact->ahead[contact->pairs[p].body[0]] != 0)
      PetscCall(TransferSetBounds(contact->pairs[p].transfer, contact->options.slip_bound, PetscMin(contact->options.angle_bound, STILL)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperRowsChanged(Contact contact)
{
  PetscScalar **aligns = Stepper(contact)->aligns;

  PetscFunctionBegin;
  Stepper(contact)->state++;
  if (ContactAllPairsTie(contact)) PetscCall(ContactSetUpTiedEnds(contact));
  if (contact->ties.inverse && !aligns[0]) PetscCall(PetscMalloc2(contact->rows.n, &aligns[0], contact->rows.n, &aligns[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperAccept(Contact contact)
{
  ContactStepper *stepper = Stepper(contact);

  PetscFunctionBegin;
  if (contact->ties.inverse) PetscCall(ContactStepperEndTies(contact, stepper));
  for (PetscInt k = 0; k < contact->rows.n_acting; k++) {
    const PetscInt i = contact->rows.acting[k];

    stepper->joined[i] = stepper->joins[i];
    stepper->grows[i]  = contact->end.force[i] - stepper->last[i];
  }
  PetscCall(ContactStepperAcceptGlue(contact, stepper));
  PetscCall(ContactStepperAcceptSecants(stepper));
  contact->counts.contact_loss += stepper->closed.loss;
  contact->energy.largest_force += stepper->closed.force; /* changes of gaps add up, and what nobody knows of them does */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which body is why contact nodes have mass, and what a hit may take then */
static PetscErrorCode ViewMass(Contact contact, PetscViewer viewer)
{
  PetscReal most  = 0;
  PetscInt  loses = 0, thin = contact->n_bodies;

  PetscFunctionBegin;
  if (ContactAllPairsTie(contact)) PetscFunctionReturn(PETSC_SUCCESS); /* nothing hits */
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal part;
    PetscBool is_thin;

    if (!ContactBodyHasMass(contact->bodies[b]) || (!contact->body_rows[b].n_all && !contact->neighbours.come_and_go)) continue;
    PetscCall(BodyChooseMass(contact->bodies[b], 0, NULL, &is_thin));
    if (is_thin && thin == contact->n_bodies) thin = b;
    PetscCall(ContactStepperGetFlatHit(contact, b, &part));
    if (part > most) loses = b;
    most = PetscMax(most, part);
  }
  if (most == 0) PetscFunctionReturn(PETSC_SUCCESS);
  if (thin < contact->n_bodies)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  body '%s' is thin: it and what it may touch keep the mass of contact nodes\n",
                                     ((PetscObject)contact->bodies[thin])->name));
  PetscCall(PetscViewerASCIIPrintf(viewer,
                                   "  contact nodes that hit lose their energy, where body '%s' hits flat up to %.2g %% of all it has\n",
                                   ((PetscObject)contact->bodies[loses])->name, (double)(100 * most)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactStepperView - rules, tolerance, and what laws have to tell */
PetscErrorCode ContactStepperView(Contact contact, PetscViewer viewer)
{
  const ContactStepper *stepper = Stepper(contact);
  PetscBool             one     = PETSC_TRUE;
  PetscReal             rtol;

  PetscFunctionBegin;
  PetscCall(SNESGetTolerances(stepper->outer, NULL, &rtol, NULL, NULL, NULL));
  for (PetscInt b = 0; b < contact->n_bodies; b++) one = (PetscBool)(one && stepper->rules[b] == stepper->rules[0]);
  PetscCall(PetscViewerASCIIPrintf(viewer, "  rule %s, tolerance %g of the largest way of a row in the step\n",
                                   one ? stepper->rules[0]->name : "as bodies need", (double)rtol));
  for (PetscInt b = 0; b < contact->n_bodies && !one; b++)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  rule of body '%s' and what it may touch: %s\n", ((PetscObject)contact->bodies[b])->name,
                                     stepper->rules[b]->name));
  PetscCall(ViewMass(contact, viewer));
  PetscCall(ContactViewLawParameters(contact, viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All but the options. Rows need no more than in all methods: lost is which of them have joined in the last step, for the guess. */
static PetscErrorCode Reset(Contact contact)
{
  ContactStepper *stepper = Stepper(contact);
  StepperTurns   *turns   = &stepper->turns;
  StepperSprings *springs = &stepper->springs;

  PetscFunctionBegin;
  PetscCall(SNESDestroy(&stepper->outer));
  PetscCall(ContactStepperDestroyAssembly(&stepper->assembly));
  PetscCall(ContactStepperDestroyVecs(stepper));
  PetscCall(ContactDestroyTiedEnds(contact));
  PetscCall(PetscFree2(stepper->aligns[0], stepper->aligns[1]));
  PetscCall(PetscFree3(stepper->parameters, stepper->history, stepper->grown));
  PetscCall(PetscFree5(turns->fixed, turns->joined, turns->softness, turns->start, turns->read));
  PetscCall(PetscFree4(turns->uneven, turns->lever, turns->own, turns->shift));
  PetscCall(PetscFree3(springs->stiffness, springs->softness, springs->multiplier));
  PetscCall(PetscFree7(stepper->rules, stepper->group, stepper->moves, stepper->rests, stepper->done, stepper->scale, stepper->off));
  PetscCall(PetscMemzero((char *)stepper + offsetof(ContactStepper, outer), sizeof(*stepper) - offsetof(ContactStepper, outer)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperDestroy(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(Reset(contact));
  PetscCall(PetscViewerDestroy(&Stepper(contact)->monitor));
  PetscCall(PetscFree(contact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*MC
   CONTACT_SCHWARZ - the contact step: forces of rows by a rule and a law; `CONTACT_FORCE` is another name

   Options Database Keys:
+  -contact_monitor                    - a line for each pass of a step
.  -contact_rule (auto|impulse|linear) - how forces run within a step, and when a row counts as closed
.  -schwarz_snes_...                   - the outer iteration, a `SNES`, with defaults in options/README.md
-  -law_snes_...                       - how the law of all rows is solved: Newton's method, and its limits

   Level: beginner

   Notes:
   Contact nodes may have mass, as those of sheets and plates. With the rule impulse contact never brings energy, and takes the kinetic
   energy of the contact nodes in the direction of the hit. Bodies that pairs connect, directly or by others, have one rule.

   References:
.  * - V. Acary, Energy conservation and dissipation properties of time-integration methods for nonsmooth elastodynamics with contact, ZAMM
       96 (2016) 585-603

.seealso: `ContactSetType()`, `CONTACT_ALTERNATION`, `ContactGetTraits()`
M*/
PetscErrorCode ContactCreate_Schwarz(Contact contact)
{
  ContactStepper *stepper;

  PetscFunctionBegin;
  PetscCall(PetscNew(&stepper));
  contact->data     = stepper;
  contact->sideless = contact->impulses = PETSC_TRUE;
  contact->ops->setfromoptions          = SetFromOptions;
  contact->ops->setup                   = ContactStepperSetUp;
  contact->ops->layrows                 = LayRows;
  contact->ops->step                    = ContactStepperStep;
  contact->ops->rowschanged             = ContactStepperRowsChanged;
  contact->ops->stored                  = ContactStoresNothing;
  contact->ops->steplevel               = ContactStepperRowsChanged;
  contact->ops->accept                  = ContactStepperAccept;
  contact->ops->visit                   = ContactStepperVisit;
  contact->ops->visitshared             = ContactStepperVisitShared;
  contact->ops->visittables             = ContactStepperVisitTables;
  contact->ops->maybalance              = ContactStepperMayTurn;
  contact->ops->reset                   = Reset;
  contact->ops->view                    = ContactStepperView;
  contact->ops->destroy                 = ContactStepperDestroy;
  PetscFunctionReturn(PETSC_SUCCESS);
}
