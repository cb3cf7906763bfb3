/* Free space on the disk. */
#include "freespace.h"
#include <petscsys.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

/* Free space where the file `path` will be, the space of the file that it replaces included [bytes]; a huge number if the file system does
   not tell */
double OutputFreeSpace(const char path[])
{
  char           folder[PETSC_MAX_PATH_LEN];
  char          *slash;
  struct statvfs system;
  struct stat    old;

  snprintf(folder, sizeof(folder), "%s", path);
  slash = strrchr(folder, '/');
  if (slash) slash[1] = '\0';
  else snprintf(folder, sizeof(folder), ".");
  if (statvfs(folder, &system) || !system.f_blocks) return PETSC_MAX_REAL;
  return (double)system.f_bavail * (double)system.f_frsize + (stat(path, &old) ? 0 : 512. * (double)old.st_blocks);
}
