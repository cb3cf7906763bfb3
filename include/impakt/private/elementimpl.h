/* What the implementation of an element needs: flat loops over all elements of a body on this rank. */
#pragma once
#include <impakt/element.h>
#include <petsc/private/petscimpl.h>

#define ELEMENT_MAX_NODES  10
#define ELEMENT_MAX_DOFS   30
#define ELEMENT_MAX_POINTS 48 /* load points of an element */

typedef struct _n_ElementBlocks *ElementBlocks;

/* What elements of several materials do otherwise: their set-up, the warning of locking, and their end */
typedef struct {
  PetscErrorCode (*setup)(Element, const PetscReal[]);
  PetscErrorCode (*warnoflocking)(Element);
  PetscErrorCode (*destroy)(ElementBlocks *);
} ElementBlocksOps;

/* Cross-sections of bars [m^2] and thicknesses of plane bodies [m] */
#define SECTION_SMALLEST 1e-60
#define SECTION_LARGEST  1e60

struct _ElementOps {
  PetscErrorCode (*setfromoptions)(Element);
  PetscErrorCode (*copy)(Element, Element);                                     /* what options have set, from the first to the second */
  PetscErrorCode (*setup)(Element, const PetscReal[]);                          /* coordinates of the rank's nodes */
  PetscErrorCode (*internalforce)(Element, const PetscScalar[], PetscScalar[]); /* adds to the second [N] */
  PetscErrorCode (*energy)(Element, const PetscScalar[], PetscReal *);          /* stored by all elements of this rank [J] */
  PetscErrorCode (*hourglass)(Element, const PetscScalar[], PetscReal *); /* part of that which holds modes that the points do not see; may
                                                                             be missing */
  /* derivative of the internal force of one element by displacements, row by row [N/m]; viscous: of viscousforce() by velocities, which
     only elements with that have */
  PetscErrorCode (*tangent)(Element, PetscInt, PetscBool, const PetscScalar[], PetscScalar[]);
  /* adds to the third, in [N] per [s] of damping: forces of the stress S = C : dE/dt at displacement (first) and velocity (second), with
     the rate of Green and Lagrange's strain and the material's C; for Rayleigh damping of nonlinear bodies; may be missing */
  PetscErrorCode (*viscousforce)(Element, const PetscScalar[], const PetscScalar[], PetscScalar[]);
  PetscErrorCode (*mass)(Element, PetscInt, PetscScalar[]); /* consistent mass of one element, nodes x nodes: all components have it [kg] */
  PetscErrorCode (*stress)(Element, const PetscScalar[],
                           PetscReal[]); /* Cauchy stress, mean of each element: xx yy zz xy yz xz, 6 x count [Pa] */
  PetscErrorCode (*plastic)(Element, PetscReal *,
                            PetscReal[]); /* of elements with history: plastic work of all elements of this rank [J], and the equivalent
                                             plastic strain, mean of each element; may be missing */
  PetscErrorCode (*points)(Element, PetscInt, PetscReal[], PetscReal[]); /* of one element: reference positions of its load points, n_points
                                                                            x dim [m], and their weights [m^3, m^2 x thickness or 2 pi r] */
  PetscErrorCode (*nearest)(Element, PetscInt, const PetscReal[], PetscReal[],
                            PetscReal *); /* shape functions at a position in the undeformed element, and its distance [m], 0 inside; of a
                                             position outside those at a point of the element near to it. May be missing. */
  PetscErrorCode (*view)(Element, PetscViewer);
  PetscErrorCode (*destroy)(Element);
};

/* History of the points of integration where the material has one, owned by the body: number c of point g of element e is at
   [((s / 8 * points + g) * n + c) * 8 + s % 8] with s = ElementHistorySlot(), which is e unless there are several materials; aligned to 64
   bytes, with room for a whole batch at the end */
typedef struct {
  PetscInt         n;       /* numbers of a point; 0: the material has none */
  PetscInt         points;  /* of integration, of an element */
  PetscInt         padding; /* of several materials: elements that there has to be room for beside those that there are */
  const PetscReal *start;   /* at the start of the step; NULL: as if the material were virgin, and nothing irreversible happened */
  PetscReal       *end;     /* becomes that at the end of the step with each internal force; NULL: it is not wanted */
  PetscReal        step;    /* [s]; negative: nothing flows */
  PetscBool        by_ends; /* forces at both ends of a step do the work of their mean: so plastic work is that of the mean stress */
} ElementHistory;

struct _p_Element {
  PETSCHEADER(struct _ElementOps);
  /* set by the program or by options */
  DMPolytopeType cell_type; /* DM_POLYTOPE_UNKNOWN until ElementSetCellType() */
  Material       material;
  PetscReal      cross_section;     /* of bars [m^2], thickness of plane bodies [m]; 1 for other shapes */
  PetscInt       cross_section_dim; /* dimension of the elements that the program has set it for; 0: it has not */
  PetscBool      plane_stress;      /* else plane strain */
  PetscBool      axisymmetric;      /* of plane elements: rings about x = 0, which x is the distance from */
  PetscBool      composite;         /* triangles of six nodes, or tetrahedra of ten: each of 4 or 8 cells of the mesh */
  char          *formulation;       /* NULL: the default, which the set-up finds */
  /* set by the constructor of the shape */
  PetscInt                dim, nodes; /* space dimension; nodes of one element */
  PetscInt                n_points;   /* load points of one element: a rule exact for quadratic functions at least */
  const PetscReal        *shape;      /* shape functions there, n_points x nodes; owned by the element */
  void                   *data;
  ElementBlocks           blocks; /* of elements of several materials; NULL: they have one */
  const ElementBlocksOps *blocks_ops;
  /* set-up */
  PetscInt        count;        /* elements of this rank */
  PetscLogDouble  flops;        /* of the internal force of one element, about, for -log_view */
  const PetscInt *connectivity; /* count x nodes: local node numbers, in VTK's order of vertices; owned by the body */
  PetscBool       setup;
  /* state */
  ElementHistory history;
  PetscReal      plastic_work; /* of all elements of this rank: energy() finds it too, of a material with history [J] */
  PetscInt       inverted;     /* first element of this rank that the last internalforce() or energy() found inverted; -1: none */
};

PETSC_EXTERN PetscErrorCode ElementInitializePackage(void);
PETSC_EXTERN PetscErrorCode ElementRegisterFormulation(DMPolytopeType, PetscBool, const char[], PetscErrorCode (*)(Element));
PETSC_EXTERN PetscErrorCode ElementCreate(MPI_Comm, Element *);
PETSC_EXTERN PetscErrorCode ElementSetCellType(Element, DMPolytopeType);
PETSC_EXTERN PetscErrorCode ElementSetMaterial(Element, Material);
PETSC_EXTERN PetscErrorCode ElementSetCrossSection(Element, PetscReal);
PETSC_EXTERN PetscErrorCode ElementSetThickness(Element, PetscReal);
PETSC_EXTERN PetscErrorCode ElementSetPlaneStress(Element, PetscBool);
PETSC_EXTERN PetscErrorCode ElementSetAxisymmetric(Element, PetscBool);
PETSC_EXTERN PetscErrorCode ElementGetAxisymmetric(Element, PetscBool *);
PETSC_EXTERN PetscErrorCode ElementSetFormulation(Element, const char[]);
PETSC_EXTERN PetscErrorCode ElementGetFormulation(Element, const char *[]);
PETSC_EXTERN PetscErrorCode ElementSetFromOptions(Element);
PETSC_EXTERN PetscErrorCode ElementSetUp(Element, PetscInt, const PetscInt[], const PetscReal[]);
PETSC_EXTERN PetscErrorCode ElementView(Element, PetscViewer);
PETSC_EXTERN PetscErrorCode ElementDestroy(Element *);

PETSC_INTERN PetscFunctionList ElementList, ElementFormulationList;
PETSC_INTERN PetscErrorCode    ElementFormulationKey(DMPolytopeType, PetscBool, const char[], size_t, char[]);

PETSC_INTERN PetscErrorCode ElementReadSection(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Bar2(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Tri3(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Quad4(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Tet4(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Hex8(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Quad4_MeanDilatation(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Hex8_MeanDilatation(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Enhanced(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Quad4_Reduced(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Hex8_Reduced(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Tri6(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Tet10(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Tri3_Axisymmetric(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Quad4_Axisymmetric(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Quad4_AxisymmetricMeanDilatation(Element);
PETSC_INTERN PetscErrorCode ElementSetComposite(Element);
PETSC_INTERN PetscErrorCode ElementSetBlocks(Element, PetscInt, const Material[], PetscInt, const PetscInt[]);
PETSC_INTERN PetscErrorCode ElementDuplicateOn(Element, MPI_Comm, Material, Element *);
PETSC_INTERN PetscErrorCode ElementCreateSelection(Element, PetscBool, PetscInt, const PetscInt[], const PetscInt[], const PetscReal[],
                                                   Element *);
PETSC_INTERN PetscInt       ElementHistorySlot(Element, PetscInt);
PETSC_INTERN PetscErrorCode ElementApplyFormulation(Element);
PETSC_INTERN PetscErrorCode ElementWarnOfLocking(Element);
PETSC_INTERN PetscErrorCode ElementWarnOfOneLayer(Element);
