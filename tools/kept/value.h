// What programs read as JSON, and what tables are made of.
#pragma once

#include <concepts>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lambent {

/// Nothing, a number, a text, a list, or values by name. Not nlohmann::json: what its constructors expand to took most
/// of the time that the commands took to compile.
class Value {
 public:
  using List = std::vector<Value>;
  using Fields = std::map<std::string, Value>;

  Value();
  Value(const Value&);
  Value(Value&&) noexcept;
  Value& operator=(const Value&);
  Value& operator=(Value&&) noexcept;
  ~Value();
  template <std::integral T> Value(T n) : Value() { kind_ = std::same_as<T, bool> ? Bool : Whole, whole_ = long(n); }
  Value(double n);
  Value(std::optional<double> n); // none: nothing
  Value(const char* text);
  Value(std::string text);
  Value(List list);
  template <class T> Value(const std::vector<T>& list) : Value(List(list.begin(), list.end())) {}
  static Value list() { return List(); }
  /// Values by name: name, value, name, value…
  template <class... T> static Value of(T&&... fields) { return ofPairs({Value(std::forward<T>(fields))...}); }

  /// Of JSON; nothing where it is none, or nested more than 200 levels deep.
  static Value parsed(const std::string& json);
  /// As JSON: in one line (-1), or with so many spaces of indentation.
  std::string json(int indentation) const;

  bool isNothing() const { return kind_ == Nothing; }
  bool isBool() const { return kind_ == Bool; }
  bool isWhole() const { return kind_ == Whole; }
  bool isText() const { return kind_ == Text; }
  bool isList() const { return kind_ == Several; }
  bool isObject() const { return kind_ == Object; }
  bool isNumber() const { return kind_ == Real || kind_ == Whole || kind_ == Bool; }
  double number() const;                // a bool is 0 or 1; throws RunError where it is none
  long whole() const { return whole_; } // of a whole number, and of a bool
  const std::string& text() const { return text_; }
  const List& items() const { return list_; } // of a list
  List& items() { return list_; }
  size_t size() const { return list_.size(); }
  const Fields& fields() const { return fields_; } // of an object
  Fields& fields() { return fields_; }
  std::vector<double> numbers() const;

  Value& add(Value value); // what is nothing becomes a list
  bool has(const std::string& name) const { return fields_.contains(name); }
  Value& operator[](const std::string& name); // what is nothing becomes an object
  const Value& operator[](const std::string& name) const { return fields_.at(name); }
  double numberOr(const std::string& name, double otherwise) const;
  void update(const Value& other);

 private:
  static Value ofPairs(std::initializer_list<Value> pairs);

  enum { Nothing, Bool, Whole, Real, Text, Several, Object } kind_ = Nothing;
  long whole_ = 0;
  double real_ = 0;
  std::string text_;
  List list_;
  Fields fields_;
};

} // namespace lambent
