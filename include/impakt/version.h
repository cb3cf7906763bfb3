/* The version of these headers. That of the library at run time: ImpaktGetVersion(). */
#pragma once

#define IMPAKT_VERSION_MAJOR    0
#define IMPAKT_VERSION_MINOR    1
#define IMPAKT_VERSION_SUBMINOR 0

#define IMPAKT_VERSION_TEXT_(number) #number
#define IMPAKT_VERSION_TEXT(number)  IMPAKT_VERSION_TEXT_(number)
/* As in "0.1.0" */
#define IMPAKT_VERSION                                                                                                                     \
  IMPAKT_VERSION_TEXT(IMPAKT_VERSION_MAJOR)                                                                                                \
  "." IMPAKT_VERSION_TEXT(IMPAKT_VERSION_MINOR) "." IMPAKT_VERSION_TEXT(IMPAKT_VERSION_SUBMINOR)

/* For #if: whether these headers are of that version, of an earlier one (LT), of that or an earlier one (LE), ... */
#define IMPAKT_VERSION_EQ(major, minor, subminor)                                                                                          \
  (IMPAKT_VERSION_MAJOR == (major) && IMPAKT_VERSION_MINOR == (minor) && IMPAKT_VERSION_SUBMINOR == (subminor))
#define IMPAKT_VERSION_LT(major, minor, subminor)                                                                                          \
  (IMPAKT_VERSION_MAJOR < (major) ||                                                                                                       \
   (IMPAKT_VERSION_MAJOR == (major) &&                                                                                                     \
    (IMPAKT_VERSION_MINOR < (minor) || (IMPAKT_VERSION_MINOR == (minor) && IMPAKT_VERSION_SUBMINOR < (subminor)))))
#define IMPAKT_VERSION_LE(major, minor, subminor) (IMPAKT_VERSION_LT(major, minor, subminor) || IMPAKT_VERSION_EQ(major, minor, subminor))
#define IMPAKT_VERSION_GT(major, minor, subminor) (!IMPAKT_VERSION_LE(major, minor, subminor))
#define IMPAKT_VERSION_GE(major, minor, subminor) (!IMPAKT_VERSION_LT(major, minor, subminor))
