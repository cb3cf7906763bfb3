/* The status line of a run, by a clock that the tests set: what it tells, and when.

   The functions under test are compiled here, with a clock and a wait of their own: time stands still until a test has it go on, and the
   thread that draws is woken at every moment that it has asked for, in a run that would last for hours as well. */
/* ranks: 1 */
#define _GNU_SOURCE
#include "simulation.h"
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#define NANO 1000000000LL /* ns in a second */

/* Of both threads, under the mutex of the status line */
static long long      now = 1000 * NANO; /* ns */
static long long      alarm_at;          /* when the thread that draws wants to be woken; 0: it does not wait */
static pthread_cond_t waits = PTHREAD_COND_INITIALIZER;

static int SimulatedTime(clockid_t id, struct timespec *time)
{
  assert_int_equal(id, CLOCK_MONOTONIC);
  time->tv_sec  = (time_t)(now / NANO);
  time->tv_nsec = (long)(now % NANO);
  return 0;
}

static int SimulatedWait(pthread_cond_t *, pthread_mutex_t *, const struct timespec *);

#define clock_gettime          SimulatedTime
#define pthread_cond_timedwait SimulatedWait
#undef _DEFAULT_SOURCE /* as _GNU_SOURCE has it, not as the file */
#include <sys/statusline.c>
#undef clock_gettime
#undef pthread_cond_timedwait

static int SimulatedWait(pthread_cond_t *condition, pthread_mutex_t *mutex, const struct timespec *until)
{
  alarm_at = until->tv_sec * NANO + until->tv_nsec;
  pthread_cond_signal(&waits);
  while (now <= alarm_at && !status.ends) pthread_cond_wait(condition, mutex);
  alarm_at = 0;
  return status.ends ? 0 : ETIMEDOUT;
}

/* Time goes on by so many seconds, and the thread that draws, if there is one, does what it has to at every moment until then */
static void Pass(double seconds)
{
  const long long end = now + (long long)(seconds * 1e9 + 0.5);

  pthread_mutex_lock(&status.mutex);
  while (status.running) {
    while (!alarm_at) pthread_cond_wait(&waits, &status.mutex);
    if (alarm_at >= end) break;
    now      = alarm_at + 1; /* a clock is never too early */
    alarm_at = 0;
    pthread_cond_signal(&status.ended);
  }
  now = end;
  pthread_mutex_unlock(&status.mutex);
}

/* What takes the place of standard output and standard error during a test: a file, or a terminal */
static struct {
  int   standard[2]; /* as they were */
  int   log;         /* or -1 */
  off_t read;        /* of the log */
  int   user, terminal;
  char  text[1 << 16]; /* what was read last */
} screen;

static int Redirect(int file)
{
  (void)fflush(NULL);
  for (int i = 0; i < 2; i++) {
    screen.standard[i] = dup(i + 1);
    if (screen.standard[i] < 0 || dup2(file, i + 1) < 0) return -1;
  }
  return 0;
}

static int OpenLog(void **state)
{
  char path[] = "status-line-XXXXXX";

  (void)state;
  screen.user = screen.terminal = -1;
  screen.read                   = 0;
  screen.log                    = mkstemp(path);
  if (screen.log < 0 || unlink(path)) return -1;
  return Redirect(screen.log);
}

static void SetColumns(unsigned short columns)
{
  const struct winsize size = {.ws_row = 24, .ws_col = columns};

  assert_int_equal(ioctl(screen.user, TIOCSWINSZ, &size), 0);
}

static int OpenTerminal(void **state)
{
  struct termios mode;

  (void)state;
  screen.log  = -1;
  screen.user = posix_openpt(O_RDWR | O_NOCTTY);
  if (screen.user < 0 || grantpt(screen.user) || unlockpt(screen.user)) return -1;
  screen.terminal = open(ptsname(screen.user), O_RDWR | O_NOCTTY);
  if (screen.terminal < 0 || tcgetattr(screen.terminal, &mode)) return -1;
  cfmakeraw(&mode); /* line ends as they were written */
  if (tcsetattr(screen.terminal, TCSANOW, &mode)) return -1;
  SetColumns(60);
  return Redirect(screen.terminal);
}

static int Close(void **state)
{
  (void)state;
  StatusLineEnd();
  (void)fflush(NULL);
  for (int i = 0; i < 2; i++) {
    if (dup2(screen.standard[i], i + 1) < 0) return -1;
    close(screen.standard[i]);
  }
  if (screen.log >= 0) return close(screen.log);
  return close(screen.terminal) || close(screen.user);
}

#define in_a_log(test)      cmocka_unit_test_setup_teardown(test, OpenLog, Close)
#define on_a_terminal(test) cmocka_unit_test_setup_teardown(test, OpenTerminal, Close)

/* What has been written since the last call */
static const char *Shown(void)
{
  const char end    = 1; /* the system takes its time to pass on what is written to a terminal: all is here when this is */
  size_t     length = 0;

  (void)fflush(NULL);
  if (screen.terminal >= 0) assert_int_equal(write(screen.terminal, &end, 1), 1);
  while (screen.terminal >= 0 && (!length || screen.text[length - 1] != end)) {
    const ssize_t more = read(screen.user, screen.text + length, sizeof(screen.text) - length);

    assert_true(more > 0);
    length += (size_t)more;
  }
  if (screen.terminal >= 0) length--;
  else {
    const ssize_t more = pread(screen.log, screen.text, sizeof(screen.text) - 1, screen.read);

    assert_true(more >= 0);
    length = (size_t)more;
    screen.read += more;
  }
  screen.text[length] = 0;
  return screen.text;
}

#define shows(expected) assert_string_equal(Shown(), expected)

static void lines_of_a_log(void **state)
{
  (void)state;
  ok(StatusLineBegin(PETSC_FALSE));
  Pass(10);
  StatusLineTell("mesh of body %s", "left");
  Pass(49.9);
  shows("");
  Pass(0.1 + 1e-6);
  shows("impakt: mesh of body left, 60 s so far\n");
  StatusLineSetSteps(0, 1000); /* the first step begins */
  Pass(59.9);
  shows("");
  Pass(0.1);
  shows("impakt: step 1 of 1000, 2 min so far\n");
  Pass(40);
  StatusLineSetSteps(50, 1000);
  Pass(79.9);
  shows("");
  Pass(0.1); /* 180 s for 50 steps: 3420 s for 950 */
  shows("impakt: after 4 min: step 50 of 1000, 5 %, 57 min to go\n");
  StatusLineSetSteps(51, 1000);
  Pass(240); /* 420 s for 51 */
  shows("impakt: after 8 min: step 51 of 1000, 5 %, 2 h 10 min to go\n");
  StatusLineSetSteps(999, 1000);
  Pass(480);
  shows("impakt: after 16 min: step 999 of 1000, 100 %, 1 s to go\n");
  Pass(960);
  shows("impakt: after 32 min: step 999 of 1000, 100 %, 2 s to go\n");
  Pass(1799.9);
  shows("");
  Pass(0.1); /* from now on every half an hour */
  shows("impakt: after 62 min: step 999 of 1000, 100 %, 4 s to go\n");
  Pass(1800);
  shows("impakt: after 92 min: step 999 of 1000, 100 %, 5 s to go\n");
  Pass(1800);
  shows("impakt: after 2 h 02 min: step 999 of 1000, 100 %, 7 s to go\n");
  StatusLineEnd();
  shows("");
}

/* The time to go is that of the steps which this run has made */
static void continued_run(void **state)
{
  (void)state;
  ok(StatusLineBegin(PETSC_FALSE));
  Pass(30);
  StatusLineSetSteps(600, 1097);
  Pass(20);
  StatusLineSetSteps(700, 1097);
  Pass(10 + 1e-6); /* 30 s for 100 */
  shows("impakt: after 60 s: step 700 of 1097, 64 %, 119 s to go\n");
  StatusLineEnd();
  ok(StatusLineBegin(PETSC_FALSE));
  StatusLineSetSteps(600, 1000);
  Pass(60 + 1e-6);
  shows("impakt: after 60 s: step 601 of 1000, 60 s so far\n"); /* not yet one of its own */
}

static void bar_on_a_terminal(void **state)
{
  (void)state;
  ok(StatusLineBegin(PETSC_TRUE));
  StatusLineTell("mesh of body %s", "left");
  Pass(0.999);
  shows(""); /* shorter runs have none */
  Pass(0.001 + 1e-6);
  shows("\rmesh of body left, 1 s so far");
  StatusLineSetSteps(0, 80);
  Pass(0.199);
  shows("");
  Pass(0.001);
  shows("\r[....................] step 1 of 80, 1 s so far");
  StatusLineSetSteps(20, 80);
  Pass(0.2); /* 0.4 s for 20 steps; what is longer is wiped out */
  shows("\r[#####...............]  25 %  1 s to go        ");
  for (int i = 0; i < 100; i++) {
    Pass(2);
    (void)Shown(); /* what nobody reads would fill the terminal */
  }
  StatusLineSetSteps(21, 80);
  Pass(0.2); /* 200.6 s for 21 */
  shows("\r[#####...............]  26 %  9 min to go ");
  StatusLineEnd();
  shows("\r                                         \r");
  StatusLineEnd();
  shows("");
}

static void short_run(void **state)
{
  (void)state;
  ok(StatusLineBegin(PETSC_TRUE));
  StatusLineSetSteps(0, 80);
  Pass(0.9);
  StatusLineSetSteps(79, 80);
  Pass(0.09);
  StatusLineEnd();
  shows("");
}

/* As wide as the terminal, also when that changes; the last column is left free */
static void width(void **state)
{
  const struct {
    unsigned short columns;
    int            bar, blanks; /* what is left of the line before, as far as the terminal is wide now */
  } cases[] = {{120, 80, 0}, {50, 10, 20}, {49, 0, 13}, {20, 0, 0}, {0, 40, 0}, {600, 472, 0}, {60, 20, 20}};

  (void)state;
  ok(StatusLineBegin(PETSC_TRUE));
  StatusLineSetSteps(0, 2);
  StatusLineSetSteps(1, 2);
  Pass(0.9);
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(cases); i++) {
    const int bar            = cases[i].bar;
    char      expected[1024] = "\r", time[64];

    SetColumns(cases[i].columns);
    Pass(0.2);
    for (int c = 0; c < bar + 2 && bar; c++) strcat(expected, !c ? "[" : c > bar ? "] " : c <= bar / 2 ? "#" : ".");
    snprintf(time, sizeof(time), " 50 %%  %d s to go%*s", i < 3 ? 1 : 2, cases[i].blanks, "");
    shows(strcat(expected, time));
  }
  SetColumns(10);
  Pass(0.2);
  shows("\r 50 %  2 "); /* and no more */
}

/* Messages have lines of their own: the bar is erased before, and drawn again when none has come for 0.05 s */
static void messages(void **state)
{
  const char bar[] = "\r[##########..........]  50 %  1 s to go", none[] = "\r                                       \r";
  char       expected[256];
  FILE      *file = fopen("/dev/null", "w");

  (void)state;
  ok(StatusLineBegin(PETSC_TRUE));
  StatusLineSetSteps(0, 2);
  StatusLineSetSteps(1, 2);
  ok(PetscFPrintf(PETSC_COMM_SELF, stderr, "before the bar\n"));
  shows("before the bar\n");
  Pass(1 + 1e-6);
  shows(bar);
  ok(PetscFPrintf(PETSC_COMM_SELF, file, "to another file\n"));
  shows("");
  Pass(0.149);
  ok(PetscFPrintf(PETSC_COMM_SELF, stderr, "to standard %s\n", "error"));
  snprintf(expected, sizeof(expected), "%sto standard error\n", none);
  shows(expected);
  Pass(0.051); /* to 1.2 s, when it is due */
  shows(bar);
  Pass(0.151);
  ok(PetscPrintf(PETSC_COMM_SELF, "to standard output\n"));
  snprintf(expected, sizeof(expected), "%sto standard output\n", none);
  shows(expected);
  Pass(0.049); /* to 1.4 s: too early */
  shows("");
  Pass(0.05);
  shows(bar);
  ok(PetscPrintf(PETSC_COMM_SELF, "a line that"));
  snprintf(expected, sizeof(expected), "%sa line that", none);
  shows(expected);
  Pass(0.99);
  shows(""); /* it may be long in coming */
  ok(PetscPrintf(PETSC_COMM_SELF, " ends\n"));
  shows(" ends\n");
  Pass(0.11);
  shows("\r[##########..........]  50 %  3 s to go");
  StatusLineBreak(); /* of a signal's handler */
  shows("\n");
  StatusLineEnd();
  (void)Shown();
  StatusLineBreak();
  ok(PetscPrintf(PETSC_COMM_SELF, "after it\n"));
  shows("after it\n");
  fclose(file);
}

static PetscErrorCode PassInStep(Controller controller, const ControllerFrame *frame, void *ctx)
{
  PetscFunctionBegin;
  (void)controller;
  (void)frame;
  Pass(*(const double *)ctx);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A run of ten steps, each of which takes so many seconds */
static const char *Run(const char progress[], double seconds)
{
  Simulation   simulation = {.controller = NULL};
  PetscOptions options    = options_begin("-units none %s", progress);

  AddCollision(4, 3, 0);
  ok(SimulationCreate(&simulation));
  ok(ControllerMonitorSet(simulation.controller, PassInStep, &seconds, NULL));
  ok(ControllerSolve(simulation.controller));
  assert_false(status.running);
  ok(ControllerDestroy(&simulation.controller));
  options_end(options);
  return Shown();
}

/* The bar of such a run whose steps take 0.155 s, on a terminal of 80 columns: after 1, 1.2, 1.4 s; and how it is erased */
static const char bar_of_a_run[] =
    "\r[########################................]  60 %  1 s to go\r[############################............]  70 %  1 s to go"
    "\r[####################################....]  90 %  0 s to go\r                                                           \r";

static void option_in_a_log(void **state)
{
  const char lines[] = "impakt: after 60 s: step 1 of 10, 10 %, 9 min to go\nimpakt: after 2 min: step 3 of 10, 30 %, 5 min to go\n"
                       "impakt: after 4 min: step 7 of 10, 70 %, 103 s to go\n";

  (void)state;
  assert_string_equal(Run("", 31), lines);
  assert_string_equal(Run("-progress false", 31), "");
  assert_string_equal(Run("-progress", 0.155), bar_of_a_run);
}

static void option_on_a_terminal(void **state)
{
  (void)state;
  SetColumns(80);
  assert_string_equal(Run("-progress false", 0.155), "");
  assert_string_equal(Run("", 0.155), bar_of_a_run);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      in_a_log(lines_of_a_log), in_a_log(continued_run), on_a_terminal(bar_on_a_terminal), on_a_terminal(short_run),
      on_a_terminal(width),     on_a_terminal(messages), in_a_log(option_in_a_log),        on_a_terminal(option_on_a_terminal),
  };

  return impakt_main(argc, argv, tests);
}
