#include "render/gl_shader.h"

#include <epoxy/gl.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace sahel {

namespace {

/// SAHEL_SHADERS names a folder whose files take the place of those built in: to try a change without building.
std::string text_of(std::string_view name) {
    if (const char* folder = std::getenv("SAHEL_SHADERS"))
        if (std::ifstream file(std::filesystem::path(folder) / name); file)
            return {std::istreambuf_iterator<char>(file), {}};
    const std::string_view text = shader_source(name);
    SAHEL_CHECK(!text.empty());
    return std::string(text);
}

GLuint compile(GLenum stage, std::string_view name, std::string_view shared) {
    const std::string source = "#version 450 core\n" + text_of("common.glsl") +
                               (shared.empty() ? std::string() : text_of(shared)) + text_of(name);
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
