/* Impakt's options in one table: what the program prints, and what misspelt options are compared with. */
#pragma once
#include <petscsys.h>

/* What the name of an option begins with: nothing, or the name of a body or of an obstacle and an underscore */
typedef enum { OPTION_OF_RUN, OPTION_OF_BODY, OPTION_OF_OBSTACLE } OptionOwner;

typedef struct {
  const char *name; /* a word, to be given after -help */
  const char *text; /* what its options are about, in a line */
} OptionTopic;

typedef struct {
  const char *topic; /* name of an `OptionTopic` */
  OptionOwner owner;
  const char *name;  /* without what it begins with */
  const char *value; /* what it takes */
  const char *text;
} KnownOption;

PETSC_INTERN const KnownOption *KnownOptionsGet(size_t *);
PETSC_INTERN const OptionTopic *OptionTopicsGet(size_t *);
