/* Class id, events and names, apart from the registry: that knows the methods, and the methods know these. */
#include <contact/parts.h>

PetscClassId      CONTACT_CLASSID = 0;
PetscLogEvent     CONTACT_Step, CONTACT_Sweep, CONTACT_Update, CONTACT_Factor;
const char *const ContactConstraints[] = {"gap", "gap_rate", "both", "ContactConstraint", "CONTACT_CONSTRAINT_", NULL};
