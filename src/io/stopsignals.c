/* Signals that end a run in good order, or ask it for a checkpoint. Nothing is done when a signal comes but that the process takes note of
   it, and that without a variable: which function handles a signal tells whether it has come. SIGINT and SIGTERM are handled by Note()
   until they come. After that SIGINT has its default, so that the second Ctrl-C ends the run at once, and SIGTERM is ignored, since whoever
   starts several ranks may send it more than once. SIGHUP, which comes when the terminal is closed, is handled by Noted() after it has
   come.
   SIGUSR1 is handled by Note() until it comes, then by Noted() until it has been taken.

   Before that, while meshes are read and matrices made, there is no step to be finished and nothing to be saved: these three end the
   process at once, with a line that says so. EndAlone() handles them in a run on one rank; on several ranks EndFirst() does on the first,
   EndOther() on the others. */
#define _POSIX_C_SOURCE 200809L
#include "stopsignals.h"
#include <errno.h>
#include <fcntl.h>
#include <impakt.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/statusline.h>
#include <unistd.h>

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

/* Note() for SIGTERM on several ranks. From Ctrl-C to SIGKILL, 1 s after SIGTERM, Open MPI's mpiexec reads nothing of what the ranks print.
   Where it has room for no more, the first rank would wait until SIGKILL, without a checkpoint: what it prints from now on is dropped. */
static void NoteLaunched(int number)
{
  const int     error  = errno; /* that of the call that the signal interrupts */
  struct pollfd output = {.fd = STDOUT_FILENO, .events = POLLOUT};
  int           nowhere;

  Note(number);
  if (!poll(&output, 1, 0)) {
    nowhere = open("/dev/null", O_WRONLY);
    if (nowhere >= 0) dup2(nowhere, STDOUT_FILENO); /* a write that waits is begun again, and ends there */
  }
  errno = error;
}

const char *StopSignalName(int number, PetscBool launched)
{
  if (number == SIGTERM && launched) return "SIGTERM (mpiexec sends it for SIGINT too)";
  return number == SIGINT ? "SIGINT" : number == SIGHUP ? "SIGHUP" : "SIGTERM";
}

/* The one line, and the end. What is called here may be called where a signal is handled. */
static void End(int number, PetscBool launched)
{
  char text[256] = "impakt: ended by ";

  strcat(text, StopSignalName(number, launched));
  strcat(text, " during the set-up, before the first step: there is nothing to continue, the same command begins anew\n");
  StatusLineBreak();
  if (write(STDERR_FILENO, text, strlen(text)) < 0) _exit(IMPAKT_STOPPED); /* who would be told? */
  _exit(IMPAKT_STOPPED);
}

static void EndAlone(int number)
{
  End(number, PETSC_FALSE);
}

static void EndFirst(int number)
{
  End(number, PETSC_TRUE);
}

/* Where another rank ends, mpiexec ends the first one by SIGTERM, which has the word then */
static void EndOther(int number)
{
  (void)number;
  _exit(IMPAKT_STOPPED);
}

static PetscBool Handles(int number, void (*handler)(int))
{
  struct sigaction action;

  return (PetscBool)(!sigaction(number, NULL, &action) && action.sa_handler == handler);
}

/* From now on signals end the process with a line that says that there is nothing to continue; but SIGUSR1 is taken note of, and asks for a
   checkpoint after the first step, and two others no longer end it. An interrupt that the process ignores, as one does that a shell has
   started in the background, stays ignored, and so does the end of the terminal where nohup has started the process. */
void StopSignalsBegin(PetscMPIInt rank, PetscMPIInt size)
{
  void (*const end)(int) = rank ? EndOther : size > 1 ? EndFirst : EndAlone;

  if (!Handles(SIGINT, SIG_IGN)) Handle(SIGINT, end);
  if (!Handles(SIGHUP, SIG_IGN)) Handle(SIGHUP, end);
  Handle(SIGTERM, end);
  Handle(SIGUSR1, Note);
  Handle(SIGPIPE, SIG_IGN); /* who reads the output may stop, as in `| head`; the files go on. PETSc has a banner for it */
  Handle(SIGXFSZ, SIG_IGN); /* a file that becomes larger than the shell allows is an error with a message, not the end */
}

/* From now on signals are taken note of; those that are ignored stay so, and one for a checkpoint that has come already is not lost */
void StopSignalsCatch(PetscBool launched)
{
  if (!Handles(SIGINT, SIG_IGN)) Handle(SIGINT, Note);
  if (!Handles(SIGHUP, SIG_IGN)) Handle(SIGHUP, Note);
  Handle(SIGTERM, launched ? NoteLaunched : Note);
  if (!Handles(SIGUSR1, Noted)) Handle(SIGUSR1, Note);
}

/* Signals do again what they do by default */
void StopSignalsRelease(void)
{
  const int numbers[] = {SIGINT, SIGHUP, SIGTERM, SIGUSR1};

  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(numbers); i++)
    if (Handles(numbers[i], Note) || Handles(numbers[i], NoteLaunched) || Handles(numbers[i], Noted)) Handle(numbers[i], SIG_DFL);
}

/* What has been asked for since the last call. To be called only after StopSignalsCatch(); a signal that has come to end the run stays. */
void StopSignalsTake(StopSignals *signals)
{
  signals->stop       = Handles(SIGINT, SIG_DFL) ? SIGINT : Handles(SIGHUP, Noted) ? SIGHUP : Handles(SIGTERM, SIG_IGN) ? SIGTERM : 0;
  signals->checkpoint = Handles(SIGUSR1, Noted);
  if (signals->checkpoint) Handle(SIGUSR1, Note);
}
