/* Lagrange multipliers: which method suits the bodies. */
#include "forwardimpl.h"

/* The forward increment moves contact nodes through their mass, and all at once */
static PetscErrorCode SuitsForward(Contact contact, PetscBool *suits)
{
  PetscFunctionBegin;
  *suits = PETSC_TRUE;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const Body body = contact->bodies[b];
    PetscInt   substeps;

    PetscCall(BodyGetSubsteps(body, &substeps));
    if (!BodyDoes(body, BodyIsExplicit) || BodyDoes(body, BodyIsRedistributed) || substeps > 1) *suits = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactSetUp_Lagrange(Contact contact)
{
  MPI_Comm  comm = PetscObjectComm((PetscObject)contact);
  PetscBool forward;

  PetscFunctionBegin;
  PetscCall(SuitsForward(contact, &forward));
  if (!forward) {
    PetscCall(LagrangeSetUpImplicit(contact));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ContactRefuseFriction(contact, "forward-increment Lagrange multipliers have no friction, since their forces are not those at "
                                           "the end of the step; leave -<body>_mass_redistribute at true, or choose -contact_law "
                                           "frictionless"));
  PetscCheck(contact->options.stabilization != CONTACT_STABILIZATION_CONTACT_STABILIZED, comm, PETSC_ERR_USER_INPUT,
             "-contact_stabilization contact_stabilized works with implicit bodies only, and all are explicit; give them -<body>_ts_type "
             "alpha2, or leave the stabilization at none");
  PetscCheck(contact->options.stabilization == CONTACT_STABILIZATION_NONE, comm, PETSC_ERR_USER_INPUT,
             "-contact_stabilization naive: with forward-increment Lagrange multipliers the accelerations at the end of a step have no "
             "contact force in them yet, so that to set them to zero would take away internal forces; they do not chatter either. Leave "
             "it at none, or choose -contact_type schwarz or penalty");
  contact->energy.unlimited = "forward increments are known only after the step that they begin";
  PetscCall(ContactStepperDestroy(contact)); /* forward increments have nothing of the step */
  PetscCall(PetscMemzero(contact->ops, sizeof(*contact->ops)));
  PetscCall(LagrangeSetUpForward(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forward increments, whose matrices are made once, may not; their bodies are not known yet, but none has friction */
static PetscBool MayReplaceRows(Contact contact)
{
  return ContactAnyPairHas(contact, CONTACT_LAW_FRICTION);
}

/*MC
   CONTACT_LAGRANGE - Lagrange multipliers: contact forces that close the gap exactly

   Options Database Keys:
+  -contact_constraint (gap|gap_rate|both)                      - what they close: the gap, its rate, or both
-  -schwarz_snes_..., -law_snes_...                             - the outer iteration on the contact forces of implicit bodies, and
                                                                  how the law of rows is solved, as with `CONTACT_SCHWARZ`

   Level: beginner

   Notes:
   Forward-increment multipliers, where all bodies are explicit with the controller step as their step and mass on their contact
   nodes: the forces that begin at t_n close the gap at t_{n+1}. The velocities reported at the end of a step do not have the force
   yet that begins there.

   Otherwise the forces at t_{n+1} close the gap at t_{n+1}, by the outer iteration. Of each pair one body at least must be
   implicit or have massless contact nodes. Massless nodes are what it is good for: with mass on both sides Newmark's trapezoidal rule
   undoes each change of the force in the next step, so that forces swing, bodies chatter and energy grows, the more so where one
   side is explicit. Against it there are -contact_constraint both with -contact_stabilization naive, which end it together, and
   -contact_stabilization contact_stabilized.

   With -contact_constraint both the velocities are corrected by impulses at the end of each step in contact. The forces that are
   told have them in forward increments; for implicit bodies they matter at impact only and are left out.

    References:
+  * - N. J. Carpenter, R. L. Taylor, M. G. Katona, Lagrange constraints for transient finite element surface contact, IJNME 32
       (1991) 103-128
.  * - T. A. Laursen, V. Chawla, Design of energy conserving algorithms for frictionless dynamic contact problems, IJNME 40 (1997)
       863-886
.  * - J. M. Solberg, P. Papadopoulos, A finite element method for contact/impact, Finite Elements in Analysis and Design 30 (1998)
       297-311
-  * - T. A. Laursen, G. R. Love, Improved implicit integrators for transient impact problems, IJNME 53 (2002) 245-274

.seealso: `ContactSetType()`, `CONTACT_SCHWARZ`, `CONTACT_PENALTY`, `CONTACT_AUGMENTED_LAGRANGIAN`
M*/
PetscErrorCode ContactCreate_Lagrange(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactCreate_Schwarz(contact));
  StepperClosesEnds(contact);
  contact->ops->setfromoptions = ContactStepperSetFromOptions;
  contact->ops->setup          = ContactSetUp_Lagrange;
  contact->ops->mayreplacerows = MayReplaceRows;
  PetscFunctionReturn(PETSC_SUCCESS);
}
