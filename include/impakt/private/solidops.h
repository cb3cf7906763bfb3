/* The operations of an element from the loops of its shape and formulation: AddForces(), AddViscousForces(), GetPoints() */
#if !defined(SOLID_HAS_FORCE)
static PetscErrorCode InternalForce(Element element, const PetscScalar u[], PetscScalar f[])
{
  PetscFunctionBegin;
  element->inverted = AddForces((const Solid *)element->data, WEIGHT * element->cross_section, element->count, element->connectivity, u, f);
  PetscCall(PetscLogFlops(element->flops * (PetscLogDouble)element->count));
  PetscFunctionReturn(PETSC_SUCCESS);
}
#endif

static PetscErrorCode ViscousForce(Element element, const PetscScalar u[], const PetscScalar v[], PetscScalar f[])
{
  PetscFunctionBegin;
  AddViscousForces((const Solid *)element->data, WEIGHT * element->cross_section, element->count, element->connectivity, u, v, f);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void SetLoops(Element element)
{
  ((Solid *)element->data)->scale   = WEIGHT;
  ((Solid *)element->data)->observe = GetPoints;
  element->ops->internalforce       = InternalForce;
  element->ops->viscousforce        = ViscousForce;
}
