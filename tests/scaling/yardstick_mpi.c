/*
   Yardstick for what messages cost between two ranks: time of one of 8 bytes, bandwidth of large ones, time of a reduction of 8 bytes.
   Prints seconds and GB/s, the best of some repeats.

     mpiexec -n 2 ./yardstick_mpi
*/
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

#define LARGE   (4 << 20)
#define REPEATS 9

/* Seconds of one way between the first two ranks */
static double PingPong(int rank, char *buffer, int bytes, int times)
{
  double best = 1e9;

  for (int r = 0; r < REPEATS; r++) {
    double start;

    MPI_Barrier(MPI_COMM_WORLD);
    start = MPI_Wtime();
    for (int i = 0; i < times; i++)
      for (int turn = 0; turn < 2; turn++) {
        if (rank == turn) MPI_Send(buffer, bytes, MPI_BYTE, 1 - turn, 0, MPI_COMM_WORLD);
        else if (rank == 1 - turn) MPI_Recv(buffer, bytes, MPI_BYTE, turn, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      }
    start = (MPI_Wtime() - start) / (2.0 * times);
    if (start < best) best = start;
  }
  return best;
}

static double Reduction(int times)
{
  double best = 1e9, value = 1, sum;

  for (int r = 0; r < REPEATS; r++) {
    double start;

    MPI_Barrier(MPI_COMM_WORLD);
    start = MPI_Wtime();
    for (int i = 0; i < times; i++) MPI_Allreduce(&value, &sum, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    start = (MPI_Wtime() - start) / times;
    if (start < best) best = start;
  }
  return best;
}

int main(int argc, char **argv)
{
  int    rank, size;
  char  *buffer = calloc(LARGE, 1);
  double latency, large, reduction;

  MPI_Init(&argc, &argv);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (size < 2 || !buffer) {
    fprintf(stderr, "needs two ranks, and %d bytes on each\n", LARGE);
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  latency   = PingPong(rank, buffer, 8, 1000);
  large     = PingPong(rank, buffer, LARGE, 10);
  reduction = Reduction(1000);
  if (!rank) printf("{\"latency\": %.4e, \"GB_per_s\": %.4f, \"reduction\": %.4e}\n", latency, 1e-9 * LARGE / large, reduction);
  free(buffer);
  return MPI_Finalize();
}
