/* What an obstacle keeps. Private to src/interface. */
#pragma once
#include <impakt/expression.h>
#include <impakt/obstacle.h>
#include <petsc/private/petscimpl.h>

struct _p_Obstacle {
  PETSCHEADER(int);
  ObstacleType type;
  PetscBool    complete;     /* it has a shape and a place */
  PetscReal    point[3];     /* of the plane or axis, or the centre [m] */
  PetscReal    direction[3]; /* outward normal of the plane, or axis of the cylinder; zero for a sphere */
  PetscReal    radius;       /* of the sphere or the cylinder [m] */
  PetscInt     n_velocity;   /* components of its velocity that have been given; 0: it does not move */
  Expression   velocity[3];  /* of its surface [m/s] */
};
