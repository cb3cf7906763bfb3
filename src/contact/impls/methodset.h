/* What setters of methods have in common. Private to src/contact/impls. */
#pragma once
#include <contact/parts.h>

/* What the method of a contact problem that is not set up yet keeps, into a pointer to it: the method has to be of a type, or of another
   one (NULL: none); `name` is the constant of the type. Call as the first thing in a setter. */
#define ContactGetMethod(contact, type, other, name, method)                                                                               \
  do {                                                                                                                                     \
    PetscBool is_it, is_other = PETSC_FALSE;                                                                                               \
                                                                                                                                           \
    PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);                                                                                 \
    ContactCheckNotSetUp(contact);                                                                                                         \
    PetscCall(PetscObjectTypeCompare((PetscObject)(contact), type, &is_it));                                                               \
    if (other) PetscCall(PetscObjectTypeCompare((PetscObject)(contact), other, &is_other));                                                \
    PetscCheck(is_it || is_other, PetscObjectComm((PetscObject)(contact)), PETSC_ERR_ARG_WRONGSTATE,                                       \
               "Call ContactSetType(contact, " name ") first");                                                                            \
    *(method) = (contact)->data;                                                                                                           \
  } while (0)

/* A value of an enum whose values are 0 to `last` */
#define ContactCheckEnum(contact, value, last, what)                                                                                       \
  PetscCheck((int)(value) >= 0 && (int)(value) <= (int)(last), PetscObjectComm((PetscObject)(contact)), PETSC_ERR_ARG_OUTOFRANGE,          \
             "There is no " what " %d", (int)(value))
