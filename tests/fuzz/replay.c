/* Hands the files on the command line to a fuzz target: what fuzzing has found stays found. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t data[], size_t size);

int main(int argc, char **argv)
{
  if (LLVMFuzzerInitialize(&argc, &argv)) return 1;
  for (int i = 1; i < argc; i++) {
    FILE    *file = fopen(argv[i], "rb");
    long     size;
    uint8_t *data;

    if (!file || fseek(file, 0, SEEK_END) || (size = ftell(file)) < 0 || fseek(file, 0, SEEK_SET)) return 1;
    data = malloc((size_t)size + 1);
    if (!data || fread(data, 1, (size_t)size, file) != (size_t)size) return 1;
    (void)fclose(file);
    (void)LLVMFuzzerTestOneInput(data, (size_t)size); /* always 0 */
    free(data);
  }
  (void)printf("%d inputs\n", argc - 1);
  return 0;
}
