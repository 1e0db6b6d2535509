/*
 * OpenGL without a screen: contexts that draw into memory of the caller.
 *
 * Part of vitral, MIT or Apache-2.0. The functions and numbers are those of the OSMesa interface, so that programs work
 * with either library unchanged.
 */
#ifndef OSMESA_H
#define OSMESA_H

#include <GL/gl.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The interface's version. */
#define OSMESA_MAJOR_VERSION 11
#define OSMESA_MINOR_VERSION 2
#define OSMESA_PATCH_VERSION 0

/* Formats of the colour buffer. There are no colour index contexts: OSMESA_COLOR_INDEX is refused. */
#define OSMESA_COLOR_INDEX GL_COLOR_INDEX
#define OSMESA_RGBA GL_RGBA
#define OSMESA_BGRA 0x1
#define OSMESA_ARGB 0x2
#define OSMESA_RGB GL_RGB
#define OSMESA_BGR 0x4
#define OSMESA_RGB_565 0x5

/* For OSMesaPixelStore and OSMesaGetIntegerv. */
#define OSMESA_ROW_LENGTH 0x10 /* pixels from row to row, 0: the width */
#define OSMESA_Y_UP 0x11       /* whether the first row is the lowest, initially true */

/* For OSMesaGetIntegerv. */
#define OSMESA_WIDTH 0x20
#define OSMESA_HEIGHT 0x21
#define OSMESA_FORMAT 0x22
#define OSMESA_TYPE 0x23
#define OSMESA_MAX_WIDTH 0x24
#define OSMESA_MAX_HEIGHT 0x25

/* For the list of OSMesaCreateContextAttribs, besides OSMESA_FORMAT. */
#define OSMESA_DEPTH_BITS 0x30            /* 0, 16, 24; initially 0 */
#define OSMESA_STENCIL_BITS 0x31          /* 0, 8; initially 0 */
#define OSMESA_ACCUM_BITS 0x32            /* 0, 16; initially 0 */
#define OSMESA_PROFILE 0x33
#define OSMESA_CORE_PROFILE 0x34          /* refused */
#define OSMESA_COMPAT_PROFILE 0x35
#define OSMESA_CONTEXT_MAJOR_VERSION 0x36 /* at most 1.5 */
#define OSMESA_CONTEXT_MINOR_VERSION 0x37

typedef struct osmesa_context *OSMesaContext;
typedef void (*OSMESAproc)();

/* A context with 24 bits of depth and 8 of stencil, which shares textures, lists and buffers with `sharelist`, if that is
   not NULL. NULL if the format is unknown. */
GLAPI OSMesaContext GLAPIENTRY OSMesaCreateContext(GLenum format, OSMesaContext sharelist);

/* A context with at least these bits; 0 means none. */
GLAPI OSMesaContext GLAPIENTRY OSMesaCreateContextExt(GLenum format, GLint depthBits, GLint stencilBits, GLint accumBits,
                                                      OSMesaContext sharelist);

/* A context as the list says: pairs of attribute and value, ended by 0. NULL if it cannot be had. */
GLAPI OSMesaContext GLAPIENTRY OSMesaCreateContextAttribs(const int *attribList, OSMesaContext sharelist);

/* Frees a context. If a thread has it current, it goes when that thread lets go of it. */
GLAPI void GLAPIENTRY OSMesaDestroyContext(OSMesaContext ctx);

/* Makes a context the calling thread's, drawing to `buffer`: rows of pixels of components of `type`, GL_UNSIGNED_BYTE,
   GL_UNSIGNED_SHORT, GL_FLOAT, or GL_UNSIGNED_SHORT_5_6_5 with OSMESA_RGB_565. The buffer must stay until another one is
   given, or the context is released by making NULL and NULL current. Pictures are in the buffer after glFinish or
   glFlush, or after the context was released. GL_FALSE, and nothing changed, if that cannot be. */
GLAPI GLboolean GLAPIENTRY OSMesaMakeCurrent(OSMesaContext ctx, void *buffer, GLenum type, GLsizei width, GLsizei height);

/* The calling thread's context, or NULL. */
GLAPI OSMesaContext GLAPIENTRY OSMesaGetCurrentContext(void);

/* Says how rows lie in the current context's buffer. */
GLAPI void GLAPIENTRY OSMesaPixelStore(GLint pname, GLint value);

/* Asks for a number of the current context. */
GLAPI void GLAPIENTRY OSMesaGetIntegerv(GLint pname, GLint *value);

/* The depth buffer of a context: unsigned numbers of 2 or 4 bytes (24 bits lie in the lower ones), lowest row first. It is
   as it is at the call. GL_FALSE if there is none. */
GLAPI GLboolean GLAPIENTRY OSMesaGetDepthBuffer(OSMesaContext c, GLint *width, GLint *height, GLint *bytesPerValue,
                                                void **buffer);

/* The colour buffer of a context, with everything drawn. GL_FALSE if there is none. */
GLAPI GLboolean GLAPIENTRY OSMesaGetColorBuffer(OSMesaContext c, GLint *width, GLint *height, GLint *format, void **buffer);

/* The address of a function of OpenGL or OSMesa, NULL if there is none of this name, or it is beyond OpenGL 1.5 and the extensions. */
GLAPI OSMESAproc GLAPIENTRY OSMesaGetProcAddress(const char *funcName);

/* Whether colours of fragments are clamped to 0..1 on their way to buffers of floats, too: off by default (see ARB_color_buffer_float). */
GLAPI void GLAPIENTRY OSMesaColorClamp(GLboolean enable);

/* Accepted, without effect: there are no filters. */
GLAPI void GLAPIENTRY OSMesaPostprocess(OSMesaContext osmesa, const char *filter, unsigned enable_value);

#ifdef __cplusplus
}
#endif

#endif
