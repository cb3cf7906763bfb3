/* How far a run is: a line on the terminal that is drawn over and over, or, in a log, a line of text now and then.

   A thread draws it, since a run may be busy for minutes with one mesh, one factorisation or one step. The thread calls neither MPI nor
   PETSc. What is printed by PETSc's functions meanwhile gets lines of its own: the status line is erased before, and drawn again below. */
#define _DEFAULT_SOURCE
#include "statusline.h"
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#define BAR_AFTER  1.0    /* s: shorter runs have no line */
#define BAR_EVERY  0.2    /* s */
#define BAR_QUIET  0.05   /* s: after a message, which may take its way to the terminal */
#define BAR_TEXT   40     /* columns for what stands beside the bar */
#define BAR_LEAST  10     /* columns: less is no bar */
#define LOG_FIRST  60.0   /* s: then after twice the time, and so on */
#define LOG_RARELY 1800.0 /* s: but at least so often */
#define WIDTH      80     /* columns where the terminal does not tell */
#define MOST_WIDTH 512

/* There is one terminal for the process, and PETSc's hook for all that it prints (PetscVFPrintf) has no context. */
static struct {
  PetscBool       running;
  PetscBool       bar;      /* or lines in a log */
  int             terminal; /* where it is drawn */
  pthread_t       thread;
  pthread_mutex_t mutex; /* for all that follows */
  pthread_cond_t  ended;
  PetscBool       ends;
  double          begin, steps_began, printed, due; /* s: of the run, of its first step, of the last message; when the next line is due */
  char            phase[128];                       /* what is done before the first step */
  PetscInt        first, step, steps;               /* the first step told of is not 0 where a run is continued */
  int             shown;                            /* columns of the line that is drawn now */
  PetscBool       inside;                           /* a message has begun whose line has not ended */
  PetscErrorCode (*print)(FILE *, const char[], va_list);
} status = {.running = PETSC_FALSE, .mutex = PTHREAD_MUTEX_INITIALIZER};

static double Now(void)
{
  struct timespec now;

  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The terminal of the process, or, where `mpiexec` has started it, of that: its number, to be closed unless it is 2; -1: there is none.
   `mpiexec` passes on standard output and standard error in any order; what is written to its terminal at once is there before them. */
static int FindTerminal(void)
{
  char path[64];
  int  file;

  if (isatty(STDERR_FILENO)) return STDERR_FILENO;
  if (!getenv("OMPI_COMM_WORLD_RANK") && !getenv("PMI_RANK")) return -1;
  snprintf(path, sizeof(path), "/proc/%ld/fd/2", (long)getppid());
  file = open(path, O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file >= 0 && isatty(file)) return file;
  if (file >= 0) close(file);
  return -1;
}

/* Whether standard error ends at a terminal; not Collective */
PetscBool StatusLineHasTerminal(void)
{
  const int terminal = FindTerminal();

  if (terminal > STDERR_FILENO) close(terminal);
  return (PetscBool)(terminal >= 0);
}

/* Columns of the terminal, which the user may change at any time */
static int GetWidth(void)
{
  struct winsize size;

  if (ioctl(status.terminal, TIOCGWINSZ, &size) || !size.ws_col) return WIDTH;
  return size.ws_col < MOST_WIDTH ? size.ws_col : MOST_WIDTH;
}

static void PrintDuration(double seconds, size_t size, char text[])
{
  if (seconds < 120) snprintf(text, size, "%.0f s", seconds);
  else if (seconds < 7200) snprintf(text, size, "%.0f min", seconds / 60);
  else snprintf(text, size, "%.0f h %02d min", (double)(long)(seconds / 3600), (int)((long)(seconds / 60) % 60));
}

/* What is being done, and how long it will take */
static void Describe(double now, PetscBool brief, size_t size, char text[])
{
  const double share = status.steps ? (double)status.step / (double)status.steps : 0;
  char         time[64];

  if (status.step > status.first) {
    PrintDuration((now - status.steps_began) * (double)(status.steps - status.step) / (double)(status.step - status.first), sizeof(time),
                  time);
    if (brief) snprintf(text, size, "%3.0f %%  %s to go", 100 * share, time);
    else snprintf(text, size, "step %lld of %lld, %.0f %%, %s to go", (long long)status.step, (long long)status.steps, 100 * share, time);
  } else {
    PrintDuration(now - status.begin, sizeof(time), time);
    if (status.steps) snprintf(text, size, "step %lld of %lld, %s so far", (long long)status.first + 1, (long long)status.steps, time);
    else snprintf(text, size, "%s, %s so far", status.phase, time);
  }
}

static void Erase(void)
{
  if (status.shown) dprintf(status.terminal, "\r%*s\r", status.shown, "");
  status.shown = 0;
}

static void DrawBar(double now)
{
  char text[256], line[2 * MOST_WIDTH];
  int  width = GetWidth() - 1, bar, done, length; /* in the last column some terminals begin the next line */

  Describe(now, PETSC_TRUE, sizeof(text), text);
  bar = width + 1 - BAR_TEXT;
  if (!status.steps || bar < BAR_LEAST) snprintf(line, sizeof(line), "%s", text);
  else {
    done    = (int)(bar * (double)status.step / (double)status.steps + 0.5);
    line[0] = '[';
    memset(line + 1, '#', (size_t)done);
    memset(line + 1 + done, '.', (size_t)(bar - done));
    snprintf(line + 1 + bar, sizeof(line) - (size_t)bar - 1, "] %s", text);
  }
  length = (int)strlen(line);
  if (length > width) length = width;
  dprintf(status.terminal, "\r%.*s%*s", length, line, status.shown > length ? (status.shown < width ? status.shown : width) - length : 0,
          "");
  status.shown = length;
}

static void PrintLine(double now)
{
  char text[256], time[64];

  Describe(now, PETSC_FALSE, sizeof(text), text);
  PrintDuration(now - status.begin, sizeof(time), time);
  if (status.step) fprintf(stderr, "impakt: after %s: %s\n", time, text);
  else fprintf(stderr, "impakt: %s\n", text);
  (void)fflush(stderr);
}

/* How long nothing is drawn after a message: its line may not be complete, and `mpiexec` takes its time [s] */
static double Quiet(void)
{
  if (status.inside) return BAR_AFTER;
  return status.terminal == STDERR_FILENO ? BAR_QUIET : BAR_EVERY;
}

static void *Draw(void *ctx)
{
  (void)ctx;
  pthread_mutex_lock(&status.mutex);
  while (!status.ends) {
    const double    now = Now();
    double          next;
    struct timespec due;

    if (now >= status.due && now - status.printed >= Quiet()) {
      if (status.bar) DrawBar(now);
      else PrintLine(now);
      if (status.bar) status.due = now + BAR_EVERY;
      else status.due = now + (now - status.begin < LOG_RARELY ? now - status.begin : LOG_RARELY);
    }
    next        = status.due > now ? status.due : now + BAR_QUIET;
    due.tv_sec  = (time_t)next;
    due.tv_nsec = (long)(1e9 * (next - (double)due.tv_sec));
    pthread_cond_timedwait(&status.ended, &status.mutex, &due);
  }
  Erase();
  pthread_mutex_unlock(&status.mutex);
  return NULL;
}

/* In place of PetscVFPrintf: messages have lines of their own */
static PetscErrorCode PrintMessage(FILE *file, const char format[], va_list arguments)
{
  const size_t length = strlen(format);

  pthread_mutex_lock(&status.mutex);
  if (file == stderr || file == stdout) {
    Erase();
    status.printed = Now();
    if (length) status.inside = (PetscBool)(format[length - 1] != '\n');
  }
  pthread_mutex_unlock(&status.mutex);
  return (*status.print)(file, format, arguments);
}

static PetscErrorCode StartThread(void)
{
  pthread_condattr_t clock;
  sigset_t           all, before;
  int                error;

  PetscFunctionBegin;
  pthread_condattr_init(&clock);
  pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
  pthread_cond_init(&status.ended, &clock);
  pthread_condattr_destroy(&clock);
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before); /* signals are for the thread that computes */
  error = pthread_create(&status.thread, NULL, Draw, NULL);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  status.running = (PetscBool)!error; /* where there can be no thread, there is no line */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Shows progress on standard error. `bar`: a line drawn over and over; else lines of a log after 1, 2, 4, ... minutes. One rank calls. */
PetscErrorCode StatusLineBegin(PetscBool bar)
{
  PetscFunctionBegin;
  StatusLineEnd();
  status.bar      = bar;
  status.terminal = FindTerminal();
  if (status.terminal < 0) status.terminal = STDERR_FILENO; /* which is none, but may be asked to have a bar */
  status.ends = status.inside = PETSC_FALSE;
  status.begin                = Now();
  status.due                  = status.begin + (bar ? BAR_AFTER : LOG_FIRST);
  status.printed              = 0;
  status.shown                = 0;
  status.step = status.steps = 0;
  PetscCall(PetscStrncpy(status.phase, "set-up", sizeof(status.phase)));
  PetscCall(StartThread());
  status.print = PetscVFPrintf;
  if (status.running) PetscVFPrintf = PrintMessage;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* StatusLineTell - what is being done in the set-up; nothing where StatusLineBegin() has not been called */
void StatusLineTell(const char format[], ...)
{
  va_list arguments;

  if (!status.running) return;
  va_start(arguments, format);
  pthread_mutex_lock(&status.mutex);
  vsnprintf(status.phase, sizeof(status.phase), format, arguments);
  pthread_mutex_unlock(&status.mutex);
  va_end(arguments);
}

/* StatusLineSetSteps - how many steps of the run have been made, 0 at the begin of the first */
void StatusLineSetSteps(PetscInt step, PetscInt steps)
{
  if (!status.running) return;
  pthread_mutex_lock(&status.mutex);
  if (!status.steps) {
    status.first       = step;
    status.steps_began = Now();
  }
  status.step  = step;
  status.steps = steps;
  pthread_mutex_unlock(&status.mutex);
}

/* StatusLineBreak - what is written next begins a line; for signal handlers, which cannot wait for the thread or its mutex */
void StatusLineBreak(void)
{
  if (status.running && status.shown && write(status.terminal, "\n", 1) < 0) return; /* without a terminal there is no line to end */
}

/* StatusLineEnd - erases the line and ends its thread; again without harm */
void StatusLineEnd(void)
{
  if (!status.running) return;
  pthread_mutex_lock(&status.mutex);
  status.ends = PETSC_TRUE;
  pthread_cond_signal(&status.ended);
  pthread_mutex_unlock(&status.mutex);
  pthread_join(status.thread, NULL);
  pthread_cond_destroy(&status.ended);
  status.running = PETSC_FALSE;
  if (PetscVFPrintf == PrintMessage) PetscVFPrintf = status.print;
  if (status.terminal > STDERR_FILENO) close(status.terminal);
}
