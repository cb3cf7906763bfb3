/* The operations of an element from the loops of its shape and formulation: AddForces(), AddViscousForces(), AddEnergy(), GetStress() */
#if !defined(SOLID_HAS_FORCE)
static PetscErrorCode InternalForce(Element element, const PetscScalar u[], PetscScalar f[])
{
  PetscFunctionBegin;
  element->inverted = AddForces((const Solid *)element->data, WEIGHT * element->cross_section, element->count, element->connectivity, u, f);
  PetscCall(PetscLogFlops(element->flops * (PetscLogDouble)ElementCountWanted(element)));
  PetscFunctionReturn(PETSC_SUCCESS);
}
#endif

static PetscErrorCode ViscousForce(Element element, const PetscScalar u[], const PetscScalar v[], PetscScalar f[])
{
  PetscFunctionBegin;
  AddViscousForces((const Solid *)element->data, WEIGHT * element->cross_section, element->count, element->connectivity, u, v, f);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Energy(Element element, const PetscScalar u[], PetscReal *energy)
{
  PetscFunctionBegin;
  *energy               = 0;
  element->plastic_work = 0;
  element->inverted     = AddEnergy((const Solid *)element->data, element->count, element->connectivity, u, energy, &element->plastic_work);
  *energy *= WEIGHT * element->cross_section;
  element->plastic_work *= WEIGHT * element->cross_section;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Stress(Element element, const PetscScalar u[], PetscReal stress[])
{
  PetscFunctionBegin;
  GetStress((const Solid *)element->data, element->count, element->connectivity, u, stress);
  PetscFunctionReturn(PETSC_SUCCESS);
}

#if defined(SOLID_HAS_HISTORY)
static PetscErrorCode Plastic(Element element, PetscReal *work, PetscReal strain[])
{
  const Solid *solid = (const Solid *)element->data;

  PetscFunctionBegin;
  GetPlastic(solid, element->count, element->connectivity, work, strain);
  *work *= WEIGHT * element->cross_section;
  PetscFunctionReturn(PETSC_SUCCESS);
}
#endif

static void SetLoops(Element element)
{
  element->ops->internalforce = InternalForce;
  element->ops->viscousforce  = ViscousForce;
  element->ops->energy        = Energy;
  element->ops->stress        = Stress;
#if defined(SOLID_HAS_HISTORY)
  element->ops->plastic = Plastic;
#endif
}
