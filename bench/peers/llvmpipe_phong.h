// Per-pixel Phong shading in GLSL 1.20. Include after GL's headers with GL_GLEXT_PROTOTYPES.
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

#include "raster/scene.h"

namespace pac::llvmpipe {

// The formula of raster/README.md in each pixel: what fixed-function lighting does at the vertices.
inline constexpr const char* kPhongVertex = R"(#version 120
varying vec3 position, normal;
varying vec4 color;
void main() {
  gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
  position = gl_Vertex.xyz;
  normal = gl_Normal;
  color = gl_Color;
})";
inline constexpr const char* kPhongFragment = R"(#version 120
varying vec3 position, normal;
varying vec4 color;
uniform vec3 eye, ambient, diffuse, specular;
uniform float shininess;
uniform vec4 light_place[2];  // w = 0: unit vector towards the light
uniform vec3 light_color[2];
void main() {
  vec3 n = normalize(normal), to_eye = normalize(eye - position);
  vec3 base = ambient, highlight = vec3(0.0);
  for (int i = 0; i < 2; ++i) {
    vec3 to_light = light_place[i].xyz;
    if (light_place[i].w != 0.0) to_light = normalize(to_light - position);
    float along = dot(n, to_light);
    if (along > 0.0) {
      base += diffuse * light_color[i] * along;
      float half_angle = max(dot(n, normalize(to_light + to_eye)), 0.0);
      highlight += specular * light_color[i] * pow(half_angle, shininess);
    }
  }
  gl_FragColor = vec4(color.rgb * base + highlight, 1.0);
})";

inline GLuint compile_shader(GLenum kind, const char* source) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint ok = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  char log[1024] = "";
  glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  if (ok != GL_TRUE) std::printf("shader: %s\n", log);
  return shader;
}

// Two lights, one material.
inline GLuint make_phong_program(const raster::Scene& scene, const raster::Camera& camera) {
  const GLuint program = glCreateProgram();
  glAttachShader(program, compile_shader(GL_VERTEX_SHADER, kPhongVertex));
  glAttachShader(program, compile_shader(GL_FRAGMENT_SHADER, kPhongFragment));
  glLinkProgram(program);
  GLint ok = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  if (ok != GL_TRUE) std::puts("shaders do not link");
  glUseProgram(program);
  const auto set = [&](const char* name, glm::vec3 v) {
    glUniform3f(glGetUniformLocation(program, name), v.x, v.y, v.z);
  };
  const raster::Material& m = scene.materials[0];
  set("eye", camera.eye);
  set("ambient", m.ambient * scene.ambient_light);
  set("diffuse", m.diffuse);
  set("specular", m.specular);
  glUniform1f(glGetUniformLocation(program, "shininess"), static_cast<GLfloat>(m.shininess));
  raster::Light black;
  black.color = glm::vec3(0);
  for (size_t i = 0; i < 2; ++i) {
    const std::string number = "[" + std::to_string(i) + "]";
    const raster::Light light = i < scene.lights.size() ? scene.lights[i] : black;
    const bool point = light.kind == raster::Light::Kind::point;
    const glm::vec3 at = point ? light.position : -light.direction;
    const float scale = point ? 1.0f : 1.0f / std::sqrt(at.x * at.x + at.y * at.y + at.z * at.z);
    std::string name = "light_place";
    name += number;
    glUniform4f(glGetUniformLocation(program, name.c_str()), at.x * scale, at.y * scale, at.z * scale,
                point ? 1.0f : 0.0f);
    name = "light_color";
    name += number;
    set(name.c_str(), light.color);
  }
  glUseProgram(0);
  return program;
}

}  // namespace pac::llvmpipe
