/* Lists of names in the options, of any length. */
#include "support.h"
#include <sys/names.h>

#define MANY 1000

static void none_and_many(void **state)
{
  char    **names, *list;
  PetscInt  n;
  PetscBool set;

  (void)state;
  ok(NamesRead("x_", "-names", &n, &names, &set));
  assert_int_equal(n, 0);
  assert_false(set);
  assert_null(names);

  ok(PetscMalloc1(8 * MANY, &list));
  list[0] = 0;
  for (PetscInt i = 0; i < MANY; i++) {
    char name[8];

    ok(PetscSNPrintf(name, sizeof(name), "%sn%d", i ? "," : "", (int)i));
    ok(PetscStrlcat(list, name, 8 * MANY));
  }
  ok(PetscOptionsSetValue(NULL, "-x_names", list));
  ok(NamesRead("x_", "-names", &n, &names, &set));
  assert_int_equal(n, MANY);
  assert_true(set);
  assert_string_equal(names[0], "n0");
  assert_string_equal(names[MANY - 1], "n999");
  ok(NamesDestroy(n, &names));
  assert_null(names);
  ok(PetscOptionsClearValue(NULL, "-x_names"));
  ok(PetscFree(list));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(none_and_many)};

  return impakt_main(argc, argv, tests);
}
