/* Contact between bodies: pairs, active set, and the methods that advance all bodies through a controller step. */
#pragma once
#include <impakt/body.h>
#include <impakt/stepreason.h>
#include <impakt/obstacle.h>

/*S
   Contact - the contact pairs among some bodies and the method that enforces contact

   Level: beginner

.seealso: `ContactCreate()`, `ContactSetType()`, `ContactRegister()`
S*/
typedef struct _p_Contact *Contact;

/*J
   ContactType - name of a contact method

   Values:
+ `CONTACT_SCHWARZ`              - the contact step: forces of rows by a rule and a law, also on nodes with mass
. `CONTACT_ALTERNATION`          - the Schwarz alternating method as in the paper: displacements one way, tractions the other
. `CONTACT_PENALTY`              - penalty method
. `CONTACT_LAGRANGE`             - Lagrange multipliers, implicit or forward-increment
. `CONTACT_AUGMENTED_LAGRANGIAN` - penalty method whose forces are added up until the gap is closed
- `CONTACT_FORCE`                - another name of `CONTACT_SCHWARZ`

   Level: beginner

.seealso: `ContactSetType()`
J*/
typedef const char *ContactType;
#define CONTACT_SCHWARZ              "schwarz"
#define CONTACT_ALTERNATION          "alternation"
#define CONTACT_PENALTY              "penalty"
#define CONTACT_LAGRANGE             "lagrange"
#define CONTACT_AUGMENTED_LAGRANGIAN "augmented_lagrangian"
#define CONTACT_FORCE                "force"

/*E
   ContactLaw - what contact surfaces do to each other

   Values:
+ `CONTACT_LAW_FRICTIONLESS` - they push along the normal and slide without resistance
. `CONTACT_LAW_TIED`         - nodes that lie on the partner at the start, see `-contact_tie_distance`, stay there: all components of the
                               displacement since then are equal
. `CONTACT_LAW_BONDED`       - they slide without resistance until they meet; a node that has been pushed against the partner stays there
                               from the next controller step on
. `CONTACT_LAW_GLUE`         - nodes that lie on the partner at the start are glued to it, by a law of glue that has a name of its own:
                               springs in all directions, which may break
- `CONTACT_LAW_FRICTION`     - they resist sliding, by a law of friction that has a name of its own

   Level: beginner

.seealso: `ContactSetLaw()`, `ContactGetPairLaw()`, `ContactGetTraits()`
E*/
typedef enum { CONTACT_LAW_FRICTIONLESS, CONTACT_LAW_TIED, CONTACT_LAW_BONDED, CONTACT_LAW_GLUE, CONTACT_LAW_FRICTION } ContactLaw;
PETSC_EXTERN const char *const ContactLaws[];

PETSC_EXTERN PetscClassId CONTACT_CLASSID;

/* The gap of a row, or of a pair, that has no partner opposite: larger than any gap, in whatever unit, and still a number that
   displacements can be added to */
#define CONTACT_NO_GAP 1e30

/*S
   ContactPairState - what a contact pair does at the end of a controller step

   Level: intermediate

.seealso: `ContactGetPairStates()`
S*/
typedef struct {
  PetscReal force;   /* resultant of the normal contact forces, compression positive [N] */
  PetscReal gap;     /* smallest normal gap [m] */
  PetscInt  active;  /* nodes in contact */
  PetscReal tension; /* largest tensile force of a node along its normal, of ties too; 0 if there is none [N] */
  PetscReal area;    /* of the active nodes; of bars, the cross-section of the body that has the rows [m^2] */
  /* on the second body; on the first act their opposites; zeros beyond the space dimension */
  PetscReal force_vector[3]; /* resultant [N] */
  PetscReal moment[3];       /* of the forces about the origin, where the nodes that have the rows are now [N m] */
  PetscReal impulse[3];      /* integral of the resultant over the accepted controller steps, whole or cut, trapezoidal [N s] */
  PetscReal normal_impulse;  /* the same of `force` [N s] */
  PetscReal friction_loss;   /* energy that friction has taken so far [J] */
  PetscReal obstacle_work;   /* work that an obstacle whose surface moves has done so far [J] */
  PetscInt  sliding;         /* of the nodes in contact those that slide, with friction */
  PetscReal beyond_impulse;  /* what nodes beyond the end of the partner bear of that; not trapezoidal [N s] */
} ContactPairState;

/* Overlap from which on bodies are inside each other [parts of an element]: faces that do not match leave about 0.01 */
#define CONTACT_OVERLAP 0.05

/*S
   ContactOverlap - the deepest point of a body inside another or an obstacle, or of another inside it

   Level: intermediate

.seealso: `ContactGetPairStates()`
S*/
typedef struct {
  PetscInt  other; /* number of the other body; obstacles are counted after all bodies; -1: there is none */
  PetscReal depth; /* distance of the point from the closest face [m] */
  PetscReal part;  /* the same in parts of the smallest face there; of tied bodies what is more than at the start */
  PetscReal x[3];  /* the point [m] */
  PetscBool pair;  /* they are a contact pair */
} ContactOverlap;

/*S
   ContactCounts - how much work the steps so far took, and what contact has done to energy in them

   Level: intermediate

.seealso: `ContactGetCounts()`
S*/
typedef struct {
  PetscInt   sweeps; /* of the last step: each body integrated once; 0 without contact */
  PetscInt64 total_sweeps;
  PetscInt   unconverged_steps; /* accepted by -schwarz_unconverged accept */
  PetscInt   set_changes;       /* rounds of the active set beyond the first, all steps */
  PetscInt   set_cycles;        /* steps in which a row joined again after it had left, and was kept */
  PetscInt   limited_steps;     /* made again since contact would have gained energy in them */
  PetscInt   unlimited_steps;   /* of these, in which it gained energy all the same */
  PetscInt64 energy_attempts;   /* how often these were made again */
  PetscInt64 inner_iterations;  /* of conjugate gradients on the interface, with friction of GMRES */
  PetscReal  friction_least;    /* least energy that friction has taken on a row in a step, by the forces at its ends; 0 or less [J] */
  PetscInt   ambiguous_steps;   /* in which friction may have had more than one solution */
  PetscReal  friction_tilt;     /* most by which normal forces were off along surfaces, in parts of what friction can bear; statics */
  PetscReal  friction_residual; /* most by which a step has missed the law of friction, de Saxce's residual [m] */
  PetscReal  contact_loss;      /* energy that contact has taken, friction apart, where `ContactTraits` have a reason [J] */
  PetscReal  glue_loss;         /* energy that damage of glue has taken [J] */
  PetscReal  spring_energy;     /* stored in springs between surfaces, of penalty methods and of `CONTACT_LAW_GLUE` [J] */
  /* energy that friction has taken: work of the forces across normals, by the rule of the integrators, half the sum of the forces at both
     ends of a substep times the displacement in it, less what penalty springs there have of it [J] */
  PetscReal      friction_loss;
  PetscReal      obstacle_work; /* of obstacles whose surface moves [J] */
  PetscInt       rebuilds;      /* of the operators between contact surfaces, beyond the first */
  PetscLogDouble seconds;       /* in sweeps */
} ContactCounts;

/*S
   ContactTraits - what laws and options let contact do

   Level: intermediate

.seealso: `ContactGetTraits()`
S*/
typedef struct {
  PetscBool   friction, glue, breaks; /* whether any pair has such a law, with damage; where pairs come and go, those to come */
  PetscBool   pulls;                  /* any pair has another law than the frictionless one */
  PetscInt    parts;                  /* of a controller step, at whose ends all bodies have a time in common: each is a step of contact */
  PetscBool   cuts;                   /* steps can be made again in halves: not where the method moves the state that they start from */
  PetscBool   separation;             /* surfaces that have met may come apart again */
  PetscBool   balance;                /* forces have the same sum along the normals of both surfaces */
  PetscBool   energy_cap;             /* steps in which contact would gain energy are made again */
  PetscReal   energy_excess;          /* how much it may gain all the same [parts of the system's] */
  PetscReal   energy_tolerance;       /* what it may take or bring in a step before that is made again in halves [parts of the same] */
  const char *unlimited;              /* why no step is kept from gaining energy; or NULL, as where contact never gains any */
  const char *not_always;             /* why some steps are not, or NULL */
  const char *takes; /* what energy contact takes by its rule, which lets it gain none, and what makes that less; or NULL */
} ContactTraits;

/* What ContactGetFields() gives for each node */
#define CONTACT_FIELDS_FORCE         0  /* three components [N] */
#define CONTACT_FIELDS_PRESSURE      3  /* [Pa] */
#define CONTACT_FIELDS_GAP           4  /* [m] */
#define CONTACT_FIELDS_ACTIVE        5  /* 1 in contact, else 0 */
#define CONTACT_FIELDS_TRACTION      6  /* of friction, along the surface: three components [Pa] */
#define CONTACT_FIELDS_SLIDING       9  /* 1 in contact and sliding, else 0 */
#define CONTACT_FIELDS_SLIP_DISTANCE 10 /* that it has slid in contact so far [m] */
#define CONTACT_FIELDS_FRICTION_LOSS 11 /* energy that friction has taken so far, per area [J/m^2] */
#define CONTACT_FIELDS_SIZE          12

PETSC_EXTERN PetscErrorCode ContactInitializePackage(void);
PETSC_EXTERN PetscErrorCode ContactRegister(const char[], PetscErrorCode (*)(Contact));
PETSC_EXTERN PetscErrorCode ContactCreate(MPI_Comm, Contact *);
PETSC_EXTERN PetscErrorCode ContactSetBodies(Contact, PetscInt, const Body[]);
PETSC_EXTERN PetscErrorCode ContactAddObstacle(Contact, Obstacle);
PETSC_EXTERN PetscErrorCode ContactAddPair(Contact, const char[]);
PETSC_EXTERN PetscErrorCode ContactGetPairRowSide(Contact, PetscInt, PetscInt *);
PETSC_EXTERN PetscErrorCode ContactSetType(Contact, ContactType);
PETSC_EXTERN PetscErrorCode ContactGetType(Contact, ContactType *);
PETSC_EXTERN PetscErrorCode ContactSetLaw(Contact, PetscInt, const char[]);
PETSC_EXTERN PetscErrorCode ContactSetLawParameter(Contact, PetscInt, const char[], const char[], PetscReal);
PETSC_EXTERN PetscErrorCode ContactGetPairLaw(Contact, PetscInt, ContactLaw *);
PETSC_EXTERN PetscErrorCode ContactGetTraits(Contact, ContactTraits *);
PETSC_EXTERN PetscErrorCode ContactSetFromOptions(Contact);
PETSC_EXTERN PetscErrorCode ContactView(Contact, PetscViewer);
PETSC_EXTERN PetscErrorCode ContactDestroy(Contact *);

PETSC_EXTERN PetscErrorCode ContactGetNumPairs(Contact, PetscInt *);
PETSC_EXTERN PetscErrorCode ContactGetPair(Contact, PetscInt, const char *[], Body *, Body *);
PETSC_EXTERN PetscErrorCode ContactGetPairStates(Contact, ContactPairState[]);
PETSC_EXTERN PetscErrorCode ContactGetCounts(Contact, ContactCounts *);
