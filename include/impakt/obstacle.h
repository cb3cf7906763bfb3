/* A rigid thing without a mesh that bodies may touch. */
#pragma once
#include <petscviewer.h>

/*S
   Obstacle - a rigid plane, sphere or cylinder that does not move, but perhaps along its surface

   Level: beginner

.seealso: `ObstacleCreate()`, `ObstacleSetShape()`, `ObstacleSetFromOptions()`, `ContactAddObstacle()`
S*/
typedef struct _p_Obstacle *Obstacle;

PETSC_EXTERN PetscClassId OBSTACLE_CLASSID;

/*E
   ObstacleType - shape of an obstacle

   Values:
+ `OBSTACLE_PLANE`    - everything behind a plane
. `OBSTACLE_SPHERE`   - a solid sphere
- `OBSTACLE_CYLINDER` - a solid cylinder without ends; a disc in two dimensions

   Level: beginner

.seealso: `Obstacle`
E*/
typedef enum { OBSTACLE_PLANE, OBSTACLE_SPHERE, OBSTACLE_CYLINDER } ObstacleType;
PETSC_EXTERN const char *const ObstacleTypes[];

PETSC_EXTERN PetscErrorCode ObstacleInitializePackage(void);
PETSC_EXTERN PetscErrorCode ObstacleCreate(MPI_Comm, const char[], Obstacle *);
PETSC_EXTERN PetscErrorCode ObstacleSetShape(Obstacle, ObstacleType, const PetscReal[], const PetscReal[], PetscReal);
PETSC_EXTERN PetscErrorCode ObstacleSetVelocity(Obstacle, const char[]);
PETSC_EXTERN PetscErrorCode ObstacleGetVelocity(Obstacle, const PetscReal[], PetscReal, PetscReal[], PetscBool *);
PETSC_EXTERN PetscErrorCode ObstacleSetFromOptions(Obstacle);
PETSC_EXTERN PetscErrorCode ObstacleGetShape(Obstacle, ObstacleType *, PetscReal[], PetscReal[]);
PETSC_EXTERN PetscErrorCode ObstacleView(Obstacle, PetscViewer);
PETSC_EXTERN PetscErrorCode ObstacleDestroy(Obstacle *);
