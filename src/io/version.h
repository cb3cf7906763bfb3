/* The version that output files carry. */
#pragma once
#if __has_include(<impakt.h>)
#  include <impakt.h>
#endif
#ifndef IMPAKT_VERSION
#  define IMPAKT_VERSION "0.1.0"
#endif
