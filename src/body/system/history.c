/* The history of a body's material, number by number at each point of integration. It is part of the state, and goes with it: there is one
   of the saved state, one of the start of the substep, and one of its end, which every internal force writes that is computed in the
   substep. Nothing is copied from step to step: buffers change their places.

   What looks at a state, energies or stresses, does so with its history held, so that nothing flows while it looks. */
#include <body/layout/bodyimpl.h>

enum { N_BUFFERS = 3 };

#define ALIGNMENT 64 /* bytes, as vectors of element loops want it */

struct _n_BodyHistory {
  size_t           size; /* numbers of all points */
  char            *memory;
  PetscReal       *buffers[N_BUFFERS];
  PetscReal       *saved, *start, *end; /* some of them: of the saved state, of the start of the substep, and of its end */
  PetscReal       *now;                 /* of the present state: one of these */
  PetscObjectId    id;                  /* the displacement that `end` belongs to */
  PetscObjectState state;               /* as it was then */
  PetscInt         epoch;               /* changes with whatever `start` points to */
};

/* Numbers of some elements' points, with room for a whole batch at the end */
static size_t GetSize(const ElementHistory *history, PetscInt count)
{
  return (size_t)((count + history->padding + 7) / 8) * 8 * (size_t)(history->points * history->n);
}

static PetscBool HasHistory(Body body)
{
  return (PetscBool)(body->history != NULL && !body->model.linearized && !body->unloaded);
}

/* Elements are to answer with the history as it is, and nothing flows */
static void Hold(Body body, const PetscReal *now)
{
  ElementHistory *history = &body->model.element->history;

  history->start = now;
  history->end   = NULL;
  history->step  = -1;
}

/* Elements are to answer for a substep from `start` */
static void Open(Body body)
{
  ElementHistory *history = &body->model.element->history;

  history->start = body->history->start;
  history->end   = body->history->end;
  history->step  = body->time.step;
}

/* Where the end of a substep can be written */
static PetscReal *FindFree(const struct _n_BodyHistory *history)
{
  for (PetscInt k = 0; k < N_BUFFERS; k++)
    if (history->buffers[k] != history->saved && history->buffers[k] != history->start) return history->buffers[k];
  return NULL;
}

/* BodySetUpHistory - with the virgin material everywhere; after BodySetUpSteps() */
PetscErrorCode BodySetUpHistory(Body body)
{
  const ElementHistory  *of_element = &body->model.element->history;
  struct _n_BodyHistory *history;
  char                  *first;
  size_t                 room;

  PetscFunctionBegin;
  if (!of_element->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscNew(&history));
  body->history = history;
  history->size = GetSize(of_element, body->model.element->count);
  room          = PetscMax(history->size, ALIGNMENT / sizeof(PetscReal)); /* where they are tells buffers apart, also those of no element */
  PetscCall(PetscCalloc1(N_BUFFERS * room * sizeof(PetscReal) + ALIGNMENT, &history->memory));
  first = history->memory + (ALIGNMENT - (size_t)history->memory % ALIGNMENT) % ALIGNMENT;
  for (size_t k = 0; k < N_BUFFERS; k++) history->buffers[k] = (PetscReal *)(void *)first + k * room;
  body->model.element->history.by_ends = body->integrator->has_inertia; /* as loads and contact forces do their work in a step, too */

  history->saved = history->start = history->now = history->buffers[0];
  history->end                                   = FindFree(history);
  Hold(body, history->now);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyDestroyHistory(Body body)
{
  PetscFunctionBegin;
  if (!body->history) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(body->history->memory));
  PetscCall(PetscFree(body->history));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyHistoryBegin - a substep begins with the present state */
PetscErrorCode BodyHistoryBegin(Body body)
{
  struct _n_BodyHistory *history = body->history;

  PetscFunctionBegin;
  if (!HasHistory(body)) PetscFunctionReturn(PETSC_SUCCESS);
  history->start = history->now;
  history->end   = FindFree(history);
  history->id    = 0;
  history->epoch++;
  Open(body);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyHistoryBeginHeld - the internal force of the first state writes its stress to the history, and nothing flows */
PetscErrorCode BodyHistoryBeginHeld(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyHistoryBegin(body));
  body->model.element->history.step = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyHistoryNote - the internal force at a displacement has been computed, and the history at the end of the substep with it */
PetscErrorCode BodyHistoryNote(Body body, Vec u)
{
  PetscFunctionBegin;
  if (!HasHistory(body) || !body->model.element->history.end) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscObjectGetId((PetscObject)u, &body->history->id));
  PetscCall(PetscObjectStateGet((PetscObject)u, &body->history->state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyHistoryTakeEnd - takes the history at the end of the substep if the last internal force was there (`taken`) */
PetscErrorCode BodyHistoryTakeEnd(Body body, PetscBool *taken)
{
  struct _n_BodyHistory *history = body->history;
  PetscObjectId          id;
  PetscObjectState       state;

  PetscFunctionBegin;
  *taken = PETSC_TRUE;
  if (!HasHistory(body)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscObjectGetId((PetscObject)body->state.u, &id));
  PetscCall(PetscObjectStateGet((PetscObject)body->state.u, &state));
  *taken = (PetscBool)(id == history->id && state == history->state);
  if (*taken) history->now = history->end;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyHistorySave - the present state becomes the saved one */
void BodyHistorySave(Body body)
{
  struct _n_BodyHistory *history = body->history;

  if (!HasHistory(body)) return;
  history->saved = history->start = history->now;
  history->end                    = FindFree(history);
  history->epoch++;
  Hold(body, history->now);
}

/* BodyHistoryRestore - the saved state becomes the present one */
void BodyHistoryRestore(Body body)
{
  struct _n_BodyHistory *history = body->history;

  if (!HasHistory(body)) return;
  history->now = history->start = history->saved;
  history->end                  = FindFree(history);
  history->epoch++;
  Hold(body, history->now);
}

/* BodyHistoryLook - elements answer for the present state, with its history as it is; `before`: for BodyHistoryLookBack() */
void BodyHistoryLook(Body body, ElementHistory *before)
{
  *before = body->model.element->history;
  if (body->history) Hold(body, body->history->now);
}

/* BodyHistoryForget - elements answer as if their material were virgin, and nothing irreversible happened */
void BodyHistoryForget(Body body, ElementHistory *before)
{
  *before                            = body->model.element->history;
  body->model.element->history.start = NULL;
}

void BodyHistoryLookBack(Body body, const ElementHistory *before)
{
  body->model.element->history = *before;
}

/* BodyHistoryCreateBuffer - room for the history of all elements, or of `n` of them; NULL where the material has none */
PetscErrorCode BodyHistoryCreateBuffer(Body body, PetscInt n, PetscInt *size, char **memory, PetscReal **buffer)
{
  PetscFunctionBegin;
  *memory = NULL;
  *buffer = NULL;
  *size   = body->history ? (PetscInt)GetSize(&body->model.element->history, n) : 0;
  if (!body->history) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc1((size_t)*size * sizeof(PetscReal) + ALIGNMENT, memory));
  *buffer = (PetscReal *)(void *)(*memory + (ALIGNMENT - (size_t)*memory % ALIGNMENT) % ALIGNMENT);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyHistoryGather - what some elements of this rank, by their numbers, begin the substep with; `now`: what the present state has */
void BodyHistoryGather(Body body, PetscBool now, Element element, const PetscInt elements[], PetscReal buffer[])
{
  const ElementHistory *history = &body->model.element->history;
  const PetscReal      *from    = now ? body->history->now : body->history->start;
  const PetscInt        width   = history->points * history->n;

  for (PetscInt i = 0; i < element->count; i++) {
    const PetscInt to = ElementHistorySlot(element, i), at = ElementHistorySlot(body->model.element, elements[i]);

    for (PetscInt k = 0; k < width; k++) buffer[(to / 8 * width + k) * 8 + to % 8] = from[(at / 8 * width + k) * 8 + at % 8];
  }
}

/* BodyHistoryGetEpoch - a number that changes with the start of the substep */
PetscInt BodyHistoryGetEpoch(Body body)
{
  return body->history ? body->history->epoch : 0;
}

/* BodyHistoryGetSaved - the history of the saved state, of all elements, for checkpoints; NULL where the material has none */
PetscReal *BodyHistoryGetSaved(Body body, size_t *size)
{
  *size = body->history ? body->history->size : 0;
  return body->history ? body->history->saved : NULL;
}
