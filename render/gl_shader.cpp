#include "render/gl_shader.h"

#include <epoxy/gl.h>

#include <array>
#include <string>

namespace sahel {

namespace {

GLuint compile(GLenum stage, std::string_view name, std::string_view shared) {
    const std::string_view body = shader_source(name);
    SAHEL_CHECK(!body.empty());
    std::string source = "#version 450 core\n";
    source += shader_source("common.glsl");
    if (!shared.empty()) source += shader_source(shared);
    source += body;
    const GLuint shader = glCreateShader(stage);
    const char* text = source.c_str();
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint ok = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (!ok) {
        std::array<char, 4096> log{};
        glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
        check_failed(std::string(name).c_str(), 0, "shader compiles", log.data());
    }
    return shader;
}

} // namespace

uint32_t link_program(std::string_view vertex, std::string_view fragment, std::string_view shared) {
    const GLuint program = glCreateProgram();
    const GLuint v = compile(GL_VERTEX_SHADER, vertex, {});
    const GLuint f = compile(GL_FRAGMENT_SHADER, fragment, shared);
    glAttachShader(program, v);
    glAttachShader(program, f);
    glLinkProgram(program);
    GLint ok = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &ok);
    if (!ok) {
        std::array<char, 4096> log{};
        glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
        check_failed(std::string(fragment).c_str(), 0, "program links", log.data());
    }
    glDeleteShader(v);
    glDeleteShader(f);
    return program;
}

} // namespace sahel
