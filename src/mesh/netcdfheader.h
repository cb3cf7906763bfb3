/* <netcdf.h>, also where Debian's netcdf-mpi.pc, which does not name the directory of its own header, leaves it unfound. */
#pragma once
#if __has_include(<netcdf.h>)
#  include <netcdf.h>
#elif __has_include(<../lib/x86_64-linux-gnu/netcdf/mpi/include/netcdf.h>)
#  include <../lib/x86_64-linux-gnu/netcdf/mpi/include/netcdf.h>
#else
#  error "netcdf.h not found: add $(pkg-config --variable=prefix netcdf-mpi)/include to the include path"
#endif
