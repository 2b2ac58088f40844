#include "engine/gl/program.h"

#include "engine/core/error.h"
#include "engine/gl/pulse.h"

#include <cstdlib>
#include <fstream>

namespace lambent::gl {

namespace fs = std::filesystem;

namespace {

/// File numbers of a compiler's log explained: "0 = gather.frag, 1 = lib/gbuffer.glsl".
std::string fileNumbers(const ShaderText& source) {
  std::string text;
  for (size_t i = 0; i < source.files.size(); ++i)
    text += (i ? ", " : "") + std::to_string(i) + " = " + source.files[i].filename().string();
  return text;
}

/// What the compiler or linker said of a shader or program.
template <class GetNumber, class GetLog> std::string logOf(GLuint name, GetNumber getNumber, GetLog getLog) {
  GLint length = 0;
  getNumber(name, GL_INFO_LOG_LENGTH, &length);
  std::string log(size_t(std::max(1, length)), ' ');
  getLog(name, length, nullptr, log.data());
  return log.c_str(); // up to its end
}

GLuint compile(GLenum stage, const ShaderText& source) {
  const GLuint shader = glCreateShader(stage);
  const char* text = source.text.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok) return shader;
  const std::string log = logOf(shader, glGetShaderiv, glGetShaderInfoLog);
  glDeleteShader(shader);
  throw RunError("shader " + source.files[0].string() + " does not compile (files: " + fileNumbers(source) + ")\n" +
                 log);
}

} // namespace

std::string ProgramDesc::key() const {
  std::string key = compute.empty() ? vertex + '|' + geometry + '|' + fragment : compute;
  for (const std::string& define : defines) key += '|' + define;
  return key;
}

Program::~Program() { glDeleteProgram(name_); }

void Program::use() const { glUseProgram(name_); }

int Program::location(const char* uniform) const {
  const auto [entry, isNew] = locations_.try_emplace(uniform, -1);
  if (isNew) entry->second = glGetUniformLocation(name_, uniform);
  return entry->second;
}

void Program::set(const char* uniform, int value) const { glProgramUniform1i(name_, location(uniform), value); }
void Program::set(const char* uniform, float value) const { glProgramUniform1f(name_, location(uniform), value); }
void Program::set(const char* uniform, const vec2& v) const { glProgramUniform2fv(name_, location(uniform), 1, &v.x); }
void Program::set(const char* uniform, const vec3& v) const { glProgramUniform3fv(name_, location(uniform), 1, &v.x); }
void Program::set(const char* uniform, const vec4& v) const { glProgramUniform4fv(name_, location(uniform), 1, &v.x); }
void Program::set(const char* uniform, const glm::ivec2& v) const {
  glProgramUniform2iv(name_, location(uniform), 1, &v.x);
}
void Program::set(const char* uniform, const mat4& m) const {
  glProgramUniformMatrix4fv(name_, location(uniform), 1, GL_FALSE, &m[0].x);
}

const Program& ProgramCache::get(const ProgramDesc& desc) {
  std::unique_ptr<Program>& slot = programs_[desc.key()];
  if (!slot || slot->name_ == 0) {
    pulse();
    slot.reset(new Program);
    slot->desc_ = desc;
    build(*slot);
  }
  return *slot;
}

void ProgramCache::build(Program& program) const {
  const ProgramDesc& desc = program.desc_;
  std::vector<std::pair<GLenum, const std::string*>> stages = {
      {GL_VERTEX_SHADER, &desc.vertex}, {GL_GEOMETRY_SHADER, &desc.geometry}, {GL_FRAGMENT_SHADER, &desc.fragment}};
  if (!desc.compute.empty()) stages = {{GL_COMPUTE_SHADER, &desc.compute}};
  std::vector<std::pair<GLenum, ShaderText>> sources;
  for (const auto& [stage, file] : stages)
    if (!file->empty()) sources.emplace_back(stage, loadShader(folder_, *file, desc.defines));
  program.files_.clear();
  for (const auto& [stage, source] : sources)
    for (const fs::path& file : source.files)
      if (!folder_.empty()) program.files_.push_back({file, fs::last_write_time(file)});
  std::vector<GLuint> shaders;
  try {
    for (const auto& [stage, source] : sources) shaders.push_back(compile(stage, source));
  } catch (...) {
    for (const GLuint shader : shaders) glDeleteShader(shader);
    throw;
  }
  const GLuint name = glCreateProgram();
  for (const GLuint shader : shaders) glAttachShader(name, shader);
  std::vector<const char*> captured;
  for (const std::string& output : desc.captured) captured.push_back(output.c_str());
  if (!captured.empty())
    glTransformFeedbackVaryings(name, GLsizei(captured.size()), captured.data(), GL_INTERLEAVED_ATTRIBS);
  glLinkProgram(name);
  for (const GLuint shader : shaders) glDeleteShader(shader);
  GLint ok = 0;
  glGetProgramiv(name, GL_LINK_STATUS, &ok);
  if (!ok) {
    const std::string log = logOf(name, glGetProgramiv, glGetProgramInfoLog);
    glDeleteProgram(name);
    throw RunError("program " + program.desc_.key() + " does not link\n" + log);
  }
  const std::string label = program.desc_.key().substr(0, 200); // GL_MAX_LABEL_LENGTH is at least 256
  glObjectLabel(GL_PROGRAM, name, GLsizei(label.size()), label.c_str());
  glDeleteProgram(program.name_);
  program.name_ = name;
  program.locations_.clear();
  dump(desc, sources);
}

void ProgramCache::dump(const ProgramDesc& desc, const std::vector<std::pair<GLenum, ShaderText>>& sources) const {
  const char* folder = std::getenv("LAMBENT_DUMP_SHADERS");
  if (!folder) return;
  fs::create_directories(folder);
  char program[20];
  std::snprintf(program, sizeof program, "%016zx-", std::hash<std::string>()(desc.key() + folder_.string()));
  for (const auto& [stage, source] : sources)
    std::ofstream(fs::path(folder) / (program + source.files[0].filename().string())) << source.text;
}

std::vector<std::string> ProgramCache::reloadChanged() {
  std::vector<std::string> messages;
  for (auto& [key, program] : programs_) {
    bool changed = false;
    for (Program::SourceFile& file : program->files_) {
      std::error_code error; // an editor may be replacing the file at this moment: look again next time
      const auto written = fs::last_write_time(file.path, error);
      if (error || written == file.written) continue;
      file.written = written; // so that a file that fails is tried again only when it changes again
      changed = true;
    }
    if (!changed) continue;
    try {
      build(*program);
      const ProgramDesc& desc = program->desc_;
      messages.push_back("reloaded " + (!desc.compute.empty()   ? desc.compute
                                        : desc.fragment.empty() ? desc.vertex
                                                                : desc.fragment));
    } catch (const RunError& error) {
      messages.push_back(error.what());
    }
  }
  return messages;
}

} // namespace lambent::gl
