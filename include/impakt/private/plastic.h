/* What the plastic models share: constants, hardening, and how much a point flows in a step. */
#pragma once
#include <impakt/private/isotropic.h>
#include <impakt/private/simd.h>

/* Strength as a function of the equivalent plastic strain */
typedef enum { HARDENING_LINEAR, HARDENING_VOCE, HARDENING_TABLE, HARDENING_JOHNSON_COOK } Hardening;

typedef struct {
  Isotropic       elastic; /* first, as the functions of isotropic models find it */
  Hardening       hardening;
  PetscReal       yield;   /* strength before any plastic strain [Pa] */
  PetscReal       modulus; /* linear: d strength / d strain; of Voce's law beside its saturation; of Johnson and Cook's the factor B [Pa] */
  PetscReal       kinematic;   /* by which the centre of the yield surface moves [Pa] */
  PetscReal       saturation;  /* of Voce's law: the strength that it tends to without the linear part [Pa] */
  PetscReal       saturate_at; /* of Voce's law: how fast, per plastic strain */
  PetscInt        n_table;
  PetscReal      *strain, *stress; /* of the table: plastic strains from 0 on, ascending, and strengths [Pa] */
  PetscReal       exponent;        /* of Johnson and Cook's law: n */
  PetscReal       rate, reference_rate;
  PetscReal       softening, room, melting, initial; /* m, and temperatures [K] */
  PetscReal       heat_fraction, specific_heat;      /* of plastic work that becomes heat; [J/(kg K)] */
  PetscReal       density;                           /* as of the material [kg/m^3] */
  MaterialKernels kernels;                           /* of the finite or the small strain */
} Plastic;

/* History of a point, 19 numbers or 25. Zero: the virgin material */
enum {
  PLASTIC_DEFORMATION = 0,   /* finite strain: inverse of the plastic deformation gradient less 1, row by row; small: the plastic strain in
                                xx yy zz xy yz xz */
  PLASTIC_STRAIN       = 9,  /* the equivalent one */
  PLASTIC_WORK         = 10, /* with what hardening stores of it: the area under the curve of hardening [J/m^3] */
  PLASTIC_STRENGTH     = 11, /* less that of the virgin material, at rest and at room temperature [Pa] */
  PLASTIC_STRESS       = 12, /* that works on the elastic strain: xx yy zz xy yz xz [Pa] */
  PLASTIC_TAKEN        = 18, /* the work again, of the mean of the stresses at both ends of each step [J/m^3] */
  PLASTIC_CENTRE       = 19, /* of the yield surface, with kinematic hardening: xx yy zz xy yz xz [Pa] */
  PLASTIC_SIZE         = 19,
  PLASTIC_SIZE_CENTRED = 25
};

/* What flow does in a step */
typedef struct {
  SimdReal strain;   /* by how much the equivalent plastic strain grows; NaN: it is not found */
  SimdReal strength; /* at the end, as PLASTIC_STRENGTH */
  SimdReal work;     /* against the strength [J/m^3] */
  SimdReal slope;    /* d strength / d strain at the end, of points that flow [Pa] */
} PlasticFlow;

PETSC_EXTERN PetscInt       PlasticGetSize(const Plastic *);
PETSC_EXTERN void           PlasticFindFlow(const Plastic *, PetscReal, const PetscReal[8], const PetscReal[][8], PlasticFlow *);
PETSC_EXTERN PetscErrorCode PlasticCompleteKernels(Material, PetscBool, MaterialKernels *);
PETSC_EXTERN PetscErrorCode PlasticKernels_Finite(Material, PetscBool, MaterialKernels *);
PETSC_EXTERN PetscErrorCode PlasticKernels_Small(Material, PetscBool, MaterialKernels *);
