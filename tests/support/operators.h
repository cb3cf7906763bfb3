/* The operator from contact forces to gaps of two blocks. */
#pragma once
#include "simulation.h"
#include <contact/compliance/interfaceoperator.h>

#define MOST_ROWS 12

/* Two blocks that do not match, one implicit and one with a massless layer, 1 kg/m^3 and 1 Pa */
static inline void create_blocks(Simulation *simulation)
{
  AddOptions("-prefix_push a_ -dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 4,5 -dm_plex_box_lower -1,0 -dm_plex_box_upper "
             "-0.01,1 -density 1 -youngs_modulus 1 -poissons_ratio 0.25 -prefix_pop "
             "-prefix_push b_ -dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 3,4 -dm_plex_box_lower 0,0 -dm_plex_box_upper 1,1 "
             "-density 1 -youngs_modulus 1 -poissons_ratio 0.25 -ts_type centraldifference -prefix_pop "
             "-bodies a,b -contact_pairs a.xmax:b.xmin -time_step 0.04 -time_end 1");
  ok(SimulationCreate(simulation));
  between(simulation->contact->rows.n_all, 5, MOST_ROWS);
}

/* All rows with both sides are solved for, but the last of all ranks where `leave` */
static inline InterfaceOperator set_up_operator(Simulation *simulation, const InterfaceSettings *settings, PetscBool leave)
{
  const Contact     contact = simulation->contact;
  InterfaceMark     marks[MOST_ROWS];
  InterfaceOperator op;

  for (PetscInt i = 0; i < contact->rows.n; i++)
    marks[i] = leave && contact->rows.begin + i == contact->rows.n_all - 1 ? INTERFACE_LEFT_OUT : INTERFACE_SOLVED;
  ok(InterfaceOperatorCreate(contact, settings, &op));
  ok(InterfaceOperatorSetRows(op, marks, 1));
  return op;
}

/* On a row of any rank, some N */
static inline PetscReal force_on(PetscInt row)
{
  return 1 + PetscSinReal(2.0 * row);
}
