// Undefines the macros of language.h.
#undef SHARED_BEGIN
#undef SHARED_END
#undef SHARED
#undef MEMBER_CONST
#undef MEMBER
#undef CACHE_LINE
#undef OUT
#undef INOUT
#undef IN
#undef INVERSE_PI
#undef ROUNDING
#undef GENERIC_STRUCT
#undef GENERIC
#undef REAL
#undef VEC3
#undef OF_REAL
#undef OF_FLOAT
#ifndef __cplusplus
#undef dot
#undef cross
#endif
