/* The papers behind the methods: `-citations` prints those whose methods a run has used. Private to src. */
#pragma once
#include <petscsys.h>

typedef enum {
  CITE_SCHWARZ,             /* contact by the Schwarz alternating method */
  CITE_MASS_REDISTRIBUTION, /* massless contact nodes */
  CITE_DUAL_MORTAR,         /* rows by dual mortar functions */
  CITE_SEGMENTS,            /* their integration over exactly cut faces */
  CITE_FORWARD_LAGRANGE,    /* forward-increment Lagrange multipliers */
  CITE_GAP_RATE,            /* the persistency condition */
  CITE_CONTACT_STABILIZED,  /* the contact-stabilized Newmark method */
  CITE_SECANTS,             /* secants of earlier steps in the outer iteration */
  CITE_COUNT
} ImpaktCitation;

PETSC_INTERN PetscErrorCode ImpaktCite(ImpaktCitation);
