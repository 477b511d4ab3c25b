# Files, tables and tests assume little-endian byte order; big-endian is untested.
if(CMAKE_CXX_BYTE_ORDER STREQUAL BIG_ENDIAN)
  message(FATAL_ERROR "This processor is big-endian: the programs are for little-endian ones alone.")
endif()
