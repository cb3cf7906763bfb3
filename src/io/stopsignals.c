/*
   Signals that end a run in good order, or ask it for a checkpoint. Nothing is done when a signal comes but that the process takes note of
   it, and that without a variable: which function handles a signal tells whether it has come. SIGINT and SIGTERM are handled by Note()
   until they come. After that SIGINT has its default, so that the second Ctrl-C ends the run at once, and SIGTERM is ignored, since whoever
   starts several ranks may send it more than once. SIGUSR1 is handled by Note() until it comes, then by Noted() until it has been taken.
*/
#define _POSIX_C_SOURCE 200809L
#include "stopsignals.h"
#include <signal.h>

static void Handle(int number, void (*handler)(int))
{
  struct sigaction action = {.sa_flags = SA_RESTART};

  sigemptyset(&action.sa_mask);
  action.sa_handler = handler;
  sigaction(number, &action, NULL);
}

static void Noted(int number)
{
  (void)number;
}

/* Of sigaction() and what it calls all may be called where a signal is handled */
static void Note(int number)
{
  Handle(number, number == SIGINT ? SIG_DFL : number == SIGTERM ? SIG_IGN : Noted);
}

static PetscBool Handles(int number, void (*handler)(int))
{
  struct sigaction action;

  return (PetscBool)(!sigaction(number, NULL, &action) && action.sa_handler == handler);
}

/* From now on. An interrupt that the process ignores, as one does that a shell has started in the background, stays ignored. */
void StopSignalsCatch(void)
{
  if (!Handles(SIGINT, SIG_IGN)) Handle(SIGINT, Note);
  Handle(SIGTERM, Note);
  Handle(SIGUSR1, Note);
}

/* Signals do again what they do by default */
void StopSignalsRelease(void)
{
  const int numbers[] = {SIGINT, SIGTERM, SIGUSR1};

  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(numbers); i++)
    if (Handles(numbers[i], Note) || Handles(numbers[i], Noted)) Handle(numbers[i], SIG_DFL);
}

/* What has been asked for since the last call. To be called only after StopSignalsCatch(); a signal that has come to end the run stays. */
void StopSignalsTake(StopSignals *signals)
{
  const PetscBool interrupted = Handles(SIGINT, SIG_DFL), terminated = Handles(SIGTERM, SIG_IGN);

  signals->stop       = (PetscBool)(interrupted || terminated);
  signals->name       = interrupted ? "SIGINT" : terminated ? "SIGTERM" : NULL;
  signals->checkpoint = Handles(SIGUSR1, Noted);
  if (signals->checkpoint) Handle(SIGUSR1, Note);
}
