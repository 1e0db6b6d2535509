//! Names that Mesa's library exports and that are beyond OpenGL 1.5 with our extensions: from the
//! Khronos registry (`gl.xml`). Programs that are linked with all symbols bound at start need them;
//! calling one is an INVALID_OPERATION.
#![allow(non_snake_case)]

use crate::current::call;
use vitral_gl::enums::INVALID_OPERATION;

/// What a call of such a function does.
#[cold]
#[inline(never)]
pub(crate) fn refuse(name: &'static str) -> usize {
    call(name, |context| {
        context.record_error(
            INVALID_OPERATION,
            name,
            "this is beyond OpenGL 1.5 and the extensions that are there",
        );
        0
    })
}

/// Exports each name as a C function that takes whatever it is given and returns 0, and makes the
/// table of them.
macro_rules! unsupported {
    ($($name:ident)+) => {
        $(
            #[unsafe(no_mangle)]
            pub(crate) extern "C" fn $name() -> usize {
                refuse(stringify!($name))
            }
        )+
        /// The functions of this file but those of [`logs`]: exported, and not handed out by name,
        /// since programs take what they are given for what there is.
        #[cfg(test)]
        pub(crate) static PROCEDURES: &[crate::procedure::Procedure] = crate::procedure::procedures! { $($name)+ };
    };
}

unsupported! {
    glActiveShaderProgram glAlphaFuncx glAttachObjectARB glAttachShader glBeginConditionalRender
    glBeginConditionalRenderNV glBeginQueryIndexed glBeginTransformFeedback glBindAttribLocation
    glBindAttribLocationARB glBindBufferBase glBindBufferRange glBindBuffersBase glBindBuffersRange
    glBindFragDataLocation glBindFragDataLocationEXT glBindFragDataLocationIndexed glBindImageTexture
    glBindImageTextures glBindProgramARB glBindProgramPipeline glBindSamplers glBindTextures glBindTransformFeedback
    glBindVertexBuffer glBindVertexBuffers glBlendBarrier glBlendEquationSeparatei glBlendEquationSeparateiARB
    glBlendEquationi glBlendEquationiARB glBlendFuncSeparatei glBlendFuncSeparateiARB glBlendFunci glBlendFunciARB
    glBufferStorage glClearBufferData glClearBufferSubData glClearBufferfi glClearBufferfv
    glClearBufferiv glClearBufferuiv glClearColorIiEXT glClearColorIuiEXT glClearColorx glClearDepthf glClearDepthx
    glClearTexImage glClearTexSubImage glClipPlanef glClipPlanex glColor4x glColorMaskIndexedEXT glColorMaski
    glColorP3ui glColorP3uiv glColorP4ui glColorP4uiv glColorSubTable glColorTable glColorTableParameterfv
    glColorTableParameteriv glCompileShader glCompileShaderARB glConvolutionFilter1D glConvolutionFilter2D
    glConvolutionParameterf glConvolutionParameterfv glConvolutionParameteri glConvolutionParameteriv
    glCopyColorSubTable glCopyColorTable glCopyConvolutionFilter1D glCopyConvolutionFilter2D glCopyImageSubData
    glCreateProgram glCreateProgramObjectARB glCreateShader glCreateShaderObjectARB glCreateShaderProgramv
    glDeleteObjectARB glDeleteProgram glDeleteProgramPipelines glDeleteProgramsARB glDeleteShader
    glDeleteTransformFeedbacks glDepthRangeArrayv glDepthRangeIndexed glDepthRangef glDepthRangex glDetachObjectARB
    glDetachShader glDisableIndexedEXT glDisableVertexAttribArray glDisableVertexAttribArrayARB glDisablei
    glDispatchCompute glDispatchComputeIndirect glDrawArraysIndirect glDrawArraysInstanced glDrawArraysInstancedARB
    glDrawArraysInstancedBaseInstance glDrawArraysInstancedEXT
    glDrawElementsIndirect glDrawElementsInstanced glDrawElementsInstancedARB glDrawElementsInstancedBaseInstance
    glDrawElementsInstancedBaseVertex glDrawElementsInstancedBaseVertexBaseInstance glDrawElementsInstancedEXT
    glDrawTransformFeedback glDrawTransformFeedbackInstanced glDrawTransformFeedbackStream
    glDrawTransformFeedbackStreamInstanced glEnableIndexedEXT glEnableVertexAttribArray glEnableVertexAttribArrayARB
    glEnablei glEndConditionalRender glEndConditionalRenderNV glEndQueryIndexed glEndTransformFeedback glFogx glFogxv
    glFramebufferParameteri glFramebufferTexture glFrustumf glFrustumx glGenProgramPipelines glGenProgramsARB
    glGenTransformFeedbacks glGetActiveAtomicCounterBufferiv glGetActiveAttrib glGetActiveAttribARB glGetActiveUniform
    glGetActiveUniformARB glGetActiveUniformBlockName glGetActiveUniformBlockiv glGetActiveUniformName
    glGetActiveUniformsiv glGetAttachedObjectsARB glGetAttachedShaders glGetAttribLocation glGetAttribLocationARB
    glGetBooleanIndexedvEXT glGetBooleani_v glGetBufferParameteri64v glGetClipPlanef glGetClipPlanex glGetColorTable
    glGetColorTableParameterfv glGetColorTableParameteriv glGetConvolutionFilter glGetConvolutionParameterfv
    glGetConvolutionParameteriv glGetDoublei_v glGetFixedv glGetFloati_v glGetFragDataIndex glGetFragDataLocation
    glGetFragDataLocationEXT glGetFramebufferParameteriv glGetGraphicsResetStatus glGetGraphicsResetStatusARB
    glGetHandleARB glGetHistogram glGetHistogramParameterfv glGetHistogramParameteriv glGetInteger64i_v
    glGetIntegerIndexedvEXT glGetIntegeri_v glGetLightxv glGetMaterialxv glGetMinmax glGetMinmaxParameterfv
    glGetMinmaxParameteriv glGetMultisamplefv glGetObjectLabelEXT glGetObjectParameterfvARB
    glGetProgramBinary glGetProgramEnvParameterdvARB glGetProgramEnvParameterfvARB
    glGetProgramInterfaceiv glGetProgramLocalParameterdvARB glGetProgramLocalParameterfvARB glGetProgramPipelineInfoLog
    glGetProgramPipelineiv glGetProgramResourceIndex glGetProgramResourceLocation glGetProgramResourceName
    glGetProgramResourceiv glGetProgramStringARB glGetProgramivARB glGetQueryIndexediv
    glGetSeparableFilter glGetShaderPrecisionFormat glGetShaderSource glGetShaderSourceARB
    glGetStringi glGetTexEnvxv glGetTexParameterIiv glGetTexParameterIivEXT glGetTexParameterIuiv
    glGetTexParameterIuivEXT glGetTexParameterxv glGetTransformFeedbackVarying glGetUniformBlockIndex
    glGetUniformIndices glGetUniformLocation glGetUniformLocationARB glGetUniformfv glGetUniformfvARB glGetUniformiv
    glGetUniformivARB glGetUniformuiv glGetUniformuivEXT glGetVertexAttribIiv glGetVertexAttribIivEXT
    glGetVertexAttribIuiv glGetVertexAttribIuivEXT glGetVertexAttribPointerv glGetVertexAttribPointervARB
    glGetVertexAttribdv glGetVertexAttribdvARB glGetVertexAttribfv glGetVertexAttribfvARB glGetVertexAttribiv
    glGetVertexAttribivARB glGetnColorTableARB glGetnCompressedTexImageARB glGetnConvolutionFilterARB
    glGetnHistogramARB glGetnMapdvARB glGetnMapfvARB glGetnMapivARB glGetnMinmaxARB glGetnPixelMapfvARB
    glGetnPixelMapuivARB glGetnPixelMapusvARB glGetnPolygonStippleARB glGetnSeparableFilterARB glGetnTexImageARB
    glGetnUniformdvARB glGetnUniformfv glGetnUniformfvARB glGetnUniformiv glGetnUniformivARB glGetnUniformuiv
    glGetnUniformuivARB glHistogram glInvalidateBufferData glInvalidateBufferSubData glInvalidateFramebuffer
    glInvalidateSubFramebuffer glInvalidateTexImage glInvalidateTexSubImage glIsEnabledIndexedEXT glIsEnabledi
    glIsProgram glIsProgramARB glIsProgramPipeline glIsShader glIsTransformFeedback glLabelObjectEXT glLightModelx
    glLightModelxv glLightx glLightxv glLineWidthx glLinkProgram glLinkProgramARB glLoadMatrixx glMaterialx
    glMaterialxv glMemoryBarrier glMemoryBarrierByRegion glMinSampleShading glMinSampleShadingARB glMinmax
    glMultMatrixx glMultiDrawArraysIndirect glMultiDrawElementsIndirect glMultiTexCoord4x glMultiTexCoordP1ui
    glMultiTexCoordP1uiv glMultiTexCoordP2ui glMultiTexCoordP2uiv glMultiTexCoordP3ui glMultiTexCoordP3uiv
    glMultiTexCoordP4ui glMultiTexCoordP4uiv glNormal3x glNormalP3ui glNormalP3uiv glOrthof glOrthox glPatchParameteri
    glPauseTransformFeedback glPointParameterx glPointParameterxv glPointSizePointerOES glPointSizex glPolygonOffsetx
    glPrimitiveBoundingBox glPrimitiveRestartIndex glProgramBinary
    glProgramEnvParameter4dARB glProgramEnvParameter4dvARB glProgramEnvParameter4fARB glProgramEnvParameter4fvARB
    glProgramLocalParameter4dARB glProgramLocalParameter4dvARB glProgramLocalParameter4fARB
    glProgramLocalParameter4fvARB glProgramParameteri glProgramStringARB glProgramUniform1f glProgramUniform1fv
    glProgramUniform1i glProgramUniform1iv glProgramUniform1ui glProgramUniform1uiv glProgramUniform2f
    glProgramUniform2fv glProgramUniform2i glProgramUniform2iv glProgramUniform2ui glProgramUniform2uiv
    glProgramUniform3f glProgramUniform3fv glProgramUniform3i glProgramUniform3iv glProgramUniform3ui
    glProgramUniform3uiv glProgramUniform4f glProgramUniform4fv glProgramUniform4i glProgramUniform4iv
    glProgramUniform4ui glProgramUniform4uiv glProgramUniformMatrix2fv glProgramUniformMatrix2x3fv
    glProgramUniformMatrix2x4fv glProgramUniformMatrix3fv glProgramUniformMatrix3x2fv glProgramUniformMatrix3x4fv
    glProgramUniformMatrix4fv glProgramUniformMatrix4x2fv glProgramUniformMatrix4x3fv
    glReadnPixels glReadnPixelsARB glReleaseShaderCompiler glResetHistogram glResetMinmax
    glResumeTransformFeedback glRotatex glSampleCoveragex glSampleMaski glScalex glScissorArrayv glScissorIndexed
    glScissorIndexedv glSecondaryColorP3ui glSecondaryColorP3uiv glSeparableFilter2D glShaderBinary glShaderSource
    glShaderSourceARB glTexBuffer glTexBufferARB glTexBufferRange
    glTexCoordP1ui glTexCoordP1uiv glTexCoordP2ui glTexCoordP2uiv glTexCoordP3ui glTexCoordP3uiv glTexCoordP4ui
    glTexCoordP4uiv glTexEnvx glTexEnvxv glTexImage2DMultisample glTexImage3DMultisample glTexParameterIiv
    glTexParameterIivEXT glTexParameterIuiv glTexParameterIuivEXT glTexParameterx glTexParameterxv
    glTexStorage2DMultisample glTexStorage3DMultisample glTextureBarrierNV glTextureStorage1DEXT glTextureStorage2DEXT
    glTextureStorage3DEXT glTextureView glTransformFeedbackVaryings glTranslatex glUniform1f glUniform1fARB
    glUniform1fv glUniform1fvARB glUniform1i glUniform1iARB glUniform1iv glUniform1ivARB glUniform1ui glUniform1uiEXT
    glUniform1uiv glUniform1uivEXT glUniform2f glUniform2fARB glUniform2fv glUniform2fvARB glUniform2i glUniform2iARB
    glUniform2iv glUniform2ivARB glUniform2ui glUniform2uiEXT glUniform2uiv glUniform2uivEXT glUniform3f glUniform3fARB
    glUniform3fv glUniform3fvARB glUniform3i glUniform3iARB glUniform3iv glUniform3ivARB glUniform3ui glUniform3uiEXT
    glUniform3uiv glUniform3uivEXT glUniform4f glUniform4fARB glUniform4fv glUniform4fvARB glUniform4i glUniform4iARB
    glUniform4iv glUniform4ivARB glUniform4ui glUniform4uiEXT glUniform4uiv glUniform4uivEXT glUniformBlockBinding
    glUniformMatrix2fv glUniformMatrix2fvARB glUniformMatrix2x3fv glUniformMatrix2x4fv glUniformMatrix3fv
    glUniformMatrix3fvARB glUniformMatrix3x2fv glUniformMatrix3x4fv glUniformMatrix4fv glUniformMatrix4fvARB
    glUniformMatrix4x2fv glUniformMatrix4x3fv glUseProgram glUseProgramObjectARB glUseProgramStages glValidateProgram
    glValidateProgramARB glValidateProgramPipeline glVertexAttrib1d glVertexAttrib1dARB glVertexAttrib1dv
    glVertexAttrib1dvARB glVertexAttrib1f glVertexAttrib1fARB glVertexAttrib1fv glVertexAttrib1fvARB glVertexAttrib1s
    glVertexAttrib1sARB glVertexAttrib1sv glVertexAttrib1svARB glVertexAttrib2d glVertexAttrib2dARB glVertexAttrib2dv
    glVertexAttrib2dvARB glVertexAttrib2f glVertexAttrib2fARB glVertexAttrib2fv glVertexAttrib2fvARB glVertexAttrib2s
    glVertexAttrib2sARB glVertexAttrib2sv glVertexAttrib2svARB glVertexAttrib3d glVertexAttrib3dARB glVertexAttrib3dv
    glVertexAttrib3dvARB glVertexAttrib3f glVertexAttrib3fARB glVertexAttrib3fv glVertexAttrib3fvARB glVertexAttrib3s
    glVertexAttrib3sARB glVertexAttrib3sv glVertexAttrib3svARB glVertexAttrib4Nbv glVertexAttrib4NbvARB
    glVertexAttrib4Niv glVertexAttrib4NivARB glVertexAttrib4Nsv glVertexAttrib4NsvARB glVertexAttrib4Nub
    glVertexAttrib4NubARB glVertexAttrib4Nubv glVertexAttrib4NubvARB glVertexAttrib4Nuiv glVertexAttrib4NuivARB
    glVertexAttrib4Nusv glVertexAttrib4NusvARB glVertexAttrib4bv glVertexAttrib4bvARB glVertexAttrib4d
    glVertexAttrib4dARB glVertexAttrib4dv glVertexAttrib4dvARB glVertexAttrib4f glVertexAttrib4fARB glVertexAttrib4fv
    glVertexAttrib4fvARB glVertexAttrib4iv glVertexAttrib4ivARB glVertexAttrib4s glVertexAttrib4sARB glVertexAttrib4sv
    glVertexAttrib4svARB glVertexAttrib4ubv glVertexAttrib4ubvARB glVertexAttrib4uiv glVertexAttrib4uivARB
    glVertexAttrib4usv glVertexAttrib4usvARB glVertexAttribBinding glVertexAttribDivisor glVertexAttribDivisorARB
    glVertexAttribFormat glVertexAttribI1i glVertexAttribI1iEXT glVertexAttribI1iv glVertexAttribI1ivEXT
    glVertexAttribI1ui glVertexAttribI1uiEXT glVertexAttribI1uiv glVertexAttribI1uivEXT glVertexAttribI2i
    glVertexAttribI2iEXT glVertexAttribI2iv glVertexAttribI2ivEXT glVertexAttribI2ui glVertexAttribI2uiEXT
    glVertexAttribI2uiv glVertexAttribI2uivEXT glVertexAttribI3i glVertexAttribI3iEXT glVertexAttribI3iv
    glVertexAttribI3ivEXT glVertexAttribI3ui glVertexAttribI3uiEXT glVertexAttribI3uiv glVertexAttribI3uivEXT
    glVertexAttribI4bv glVertexAttribI4bvEXT glVertexAttribI4i glVertexAttribI4iEXT glVertexAttribI4iv
    glVertexAttribI4ivEXT glVertexAttribI4sv glVertexAttribI4svEXT glVertexAttribI4ubv glVertexAttribI4ubvEXT
    glVertexAttribI4ui glVertexAttribI4uiEXT glVertexAttribI4uiv glVertexAttribI4uivEXT glVertexAttribI4usv
    glVertexAttribI4usvEXT glVertexAttribIFormat glVertexAttribIPointer glVertexAttribIPointerEXT glVertexAttribLFormat
    glVertexAttribP1ui glVertexAttribP1uiv glVertexAttribP2ui glVertexAttribP2uiv glVertexAttribP3ui
    glVertexAttribP3uiv glVertexAttribP4ui glVertexAttribP4uiv glVertexAttribPointer glVertexAttribPointerARB
    glVertexBindingDivisor glVertexP2ui glVertexP2uiv glVertexP3ui glVertexP3uiv glVertexP4ui glVertexP4uiv
    glViewportArrayv glViewportIndexedf glViewportIndexedfv
}
