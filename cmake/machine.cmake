# Files, tables and tests take the order of bytes for granted; nobody has tried the other one.
if(CMAKE_CXX_BYTE_ORDER STREQUAL BIG_ENDIAN)
  message(FATAL_ERROR "This processor is big-endian: the programs are for little-endian ones alone.")
endif()
