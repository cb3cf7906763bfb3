/* The papers behind the methods. PETSc keeps the list that `-citations` prints; here is which of them are in it already. */
#include "citations.h"

static const char *const texts[CITE_COUNT] = {
    [CITE_SCHWARZ]             = "@TechReport{HoyTezaurMota2021,\n"
                                 "  title  = {The {S}chwarz alternating method for multiscale contact mechanics},\n"
                                 "  author = {J. Hoy and I. Tezaur and A. Mota},\n"
                                 "  year   = {2021}\n}\n",
    [CITE_MASS_REDISTRIBUTION] = "@Article{KhenousLabordeRenard2008,\n"
                                 "  title   = {Mass redistribution method for finite element contact problems in elastodynamics},\n"
                                 "  author  = {H. B. Khenous and P. Laborde and Y. Renard},\n"
                                 "  journal = {European Journal of Mechanics A/Solids},\n"
                                 "  volume  = {27},\n"
                                 "  year    = {2008}\n}\n",
    [CITE_DUAL_MORTAR]         = "@Article{PoppGeeWall2009,\n"
                                 "  title   = {A finite deformation mortar contact formulation using a primal--dual active set strategy},\n"
                                 "  author  = {A. Popp and M. W. Gee and W. A. Wall},\n"
                                 "  journal = {International Journal for Numerical Methods in Engineering},\n"
                                 "  volume  = {79},\n"
                                 "  year    = {2009}\n}\n",
    [CITE_SEGMENTS]            = "@Article{PusoLaursen2004,\n"
                                 "  title   = {A mortar segment-to-segment contact method for large deformation solid mechanics},\n"
                                 "  author  = {M. A. Puso and T. A. Laursen},\n"
                                 "  journal = {Computer Methods in Applied Mechanics and Engineering},\n"
                                 "  volume  = {193},\n"
                                 "  year    = {2004}\n}\n",
    [CITE_FORWARD_LAGRANGE]    = "@Article{CarpenterTaylorKatona1991,\n"
                                 "  title   = {Lagrange constraints for transient finite element surface contact},\n"
                                 "  author  = {N. J. Carpenter and R. L. Taylor and M. G. Katona},\n"
                                 "  journal = {International Journal for Numerical Methods in Engineering},\n"
                                 "  volume  = {32},\n"
                                 "  year    = {1991}\n}\n",
    [CITE_GAP_RATE]            = "@Article{LaursenChawla1997,\n"
                                 "  title   = {Design of energy conserving algorithms for frictionless dynamic contact problems},\n"
                                 "  author  = {T. A. Laursen and V. Chawla},\n"
                                 "  journal = {International Journal for Numerical Methods in Engineering},\n"
                                 "  volume  = {40},\n"
                                 "  year    = {1997}\n}\n",
    [CITE_CONTACT_STABILIZED]  = "@Article{DeuflhardKrauseErtel2008,\n"
                                 "  title   = {A contact-stabilized {N}ewmark method for dynamical contact problems},\n"
                                 "  author  = {P. Deuflhard and R. Krause and S. Ertel},\n"
                                 "  journal = {International Journal for Numerical Methods in Engineering},\n"
                                 "  volume  = {73},\n"
                                 "  year    = {2008}\n}\n",
    [CITE_SECANTS]             = "@Article{DegrooteBatheVierendeels2009,\n"
                                 "  title   = {Performance of a new partitioned procedure versus a monolithic procedure in "
                                 "fluid--structure interaction},\n"
                                 "  author  = {J. Degroote and K.-J. Bathe and J. Vierendeels},\n"
                                 "  journal = {Computers \\& Structures},\n"
                                 "  volume  = {87},\n"
                                 "  year    = {2009}\n}\n",
};

/* Since the start of PETSc: its list ends with PetscFinalize() */
static PetscBool cited[CITE_COUNT], forgets = PETSC_FALSE;

static PetscErrorCode Forget(void)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(cited, CITE_COUNT));
  forgets = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* To be called where a method is switched on; a paper is listed once, however often that is */
PetscErrorCode ImpaktCite(ImpaktCitation paper)
{
  PetscFunctionBegin;
  if (!forgets) PetscCall(PetscRegisterFinalize(Forget));
  forgets = PETSC_TRUE;
  PetscCall(PetscCitationsRegister(texts[paper], &cited[paper]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
