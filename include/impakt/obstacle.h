/* A rigid thing without a mesh that bodies may touch. */
#pragma once
#include <petscsys.h>

/*S
   Obstacle - a rigid plane, sphere or cylinder that does not move

   Level: beginner

.seealso: `ObstacleCreateFromOptions()`, `ObstacleGetGap()`
S*/
typedef struct _n_Obstacle *Obstacle;

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

PETSC_EXTERN PetscErrorCode ObstacleCreateFromOptions(MPI_Comm, const char[], Obstacle *);
PETSC_EXTERN PetscErrorCode ObstacleGetGap(Obstacle, const PetscReal[], PetscReal *, PetscReal[]);
PETSC_EXTERN PetscErrorCode ObstacleGetName(Obstacle, const char *[]);
PETSC_EXTERN PetscErrorCode ObstacleDestroy(Obstacle *);
