/* Mesh, material and supports of a body, as contact methods scale by them, and which ranks have its rows. */
#pragma once
#include <impakt/body.h>

/* What contact scales by, of the undeformed body; materials are those of BodyGetSurfaceMaterial() */
typedef enum {
  BODY_CROSS_SECTION,        /* lengths and points times this are areas: of bars [m^2]; thickness of plane bodies [m]; else 1 */
  BODY_ELEMENT_SIZE,         /* edge of the line, square or cube with the mean volume of elements; of simplices, of that which holds 2 or 6
                                of them [m]; collective */
  BODY_CONTACT_ELEMENT_SIZE, /* the same of elements with a contact node, of all where there are none; collective */
  BODY_IMPEDANCE,            /* force for a unit velocity of a plane wave, for each unit of area: sqrt((lambda + 2 mu) rho) [N s/m^3]; of
                                bars sqrt(E rho) times the cross-section [N s/m] */
  BODY_ELEMENT_STIFFNESS     /* against pressure on a face: modulus of plane waves over edge length [N/m^3], times the cross-section of
                                bars [N/m]; collective */
} BodyScale;

PETSC_EXTERN PetscErrorCode BodyGetSurfaceMaterial(Body, Material *);
PETSC_EXTERN PetscErrorCode BodyGetScale(Body, BodyScale, PetscReal *);
PETSC_EXTERN PetscErrorCode BodySetContactNodes(Body, PetscInt, const PetscInt[]);
PETSC_EXTERN PetscErrorCode BodyGetHeldDofs(Body, PetscInt *, const PetscInt *[]);
PETSC_EXTERN PetscErrorCode BodyGetLed(Body, PetscBool *, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyGetInitialVelocity(Body, PetscReal[3]);
PETSC_EXTERN PetscErrorCode BodyGetAllBoxes(PetscInt, const Body[], PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyWholeRowsTellColumns(Mat, PetscBool, PetscInt, const PetscInt[]);
PETSC_EXTERN PetscErrorCode BodyWholeRowsRenew(Mat, PetscBool, const PetscInt[]);
