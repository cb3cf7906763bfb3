/* What a hit may take of a body whose contact nodes have mass: they stop where they hit, and lose their kinetic energy. */
#include "stepimpl.h"
#include <petscblaslapack.h>
#include <impakt/private/bodymass.h>

/* The most of its kinetic energy that a body loses where it hits flat: its contact nodes' part of the mass, times the part of its contact
   surfaces that faces one way. With areas A and normals n of the faces that is (l + |sum A n|) / 2 of their sum, l the largest eigenvalue
   of sum A n n^T: one for a flat surface, a half for both faces of a thin plate, a sixth for a cube or a ball. Collective. */
PetscErrorCode ContactStepperGetFlatHit(Contact contact, PetscInt b, PetscReal *part)
{
  PetscReal    sums[13] = {0}, values[3], work[32], way = 0; /* area; its vector; its tensor */
  PetscBLASInt three = 3, room = 32, info;

  PetscFunctionBegin;
  PetscCall(BodyGetContactPart(contact->bodies[b], part));
  for (PetscInt s = 0; s < contact->n_surfaces; s++) {
    const SurfaceData *data;

    if (contact->surfaces[s].body != b) continue;
    PetscCall(SurfaceGetData(contact->surfaces[s].surface, &data));
    for (PetscInt f = 0; f < data->n_faces; f++) {
      const PetscReal *normal = data->face_normals + 3 * f, area = data->face_areas[f];

      sums[0] += area;
      for (PetscInt d = 0; d < 3; d++) sums[1 + d] += area * normal[d];
      for (PetscInt i = 0; i < 9; i++) sums[4 + i] += area * normal[i / 3] * normal[i % 3];
    }
  }
  PetscCall(ContactReduce(contact, 13, MPIU_REAL, MPI_SUM, sums));
  if (sums[0] == 0) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt d = 0; d < 3; d++) way += PetscSqr(sums[1 + d]);
  PetscCallBLAS("LAPACKsyev", LAPACKsyev_("N", "L", &three, sums + 4, &three, values, work, &room, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK syev info %d", (int)info);
  *part *= 0.5 * (values[2] + PetscSqrtReal(way)) / sums[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}
