/* >>status: status codes and their texts. */
#include "fbt.h"

#define NAME_OF(name, value, text) #name,
#define VALUE_OF(name, value, text) value,
#define TEXT_OF(name, value, text) text,
static const char *const status_name[] = {FB_STATUS_LIST(NAME_OF)};
static const int status_value[] = {FB_STATUS_LIST(VALUE_OF)};
static const char *const status_text[] = {FB_STATUS_LIST(TEXT_OF)};

/* Interface: 0 is success, every failure is negative and has a value and a text of its own. */
TEST(every_status_has_its_own_value_and_text)
{
  const int n = FBT_COUNT(status_value);
  FBT_INT_EQ(FB_OK, 0);
  for (int i = 0; i < n; i++) {
    const char *text = fb_status_string((fb_status)status_value[i]);
    FBT_TRUE(text != NULL);
    FBT_TRUE(strlen(text) > 0);
    FBT_TRUE(strcmp(text, status_text[i]) == 0);
    FBT_TRUE(status_value[i] < 0 || strcmp(status_name[i], "FB_OK") == 0);
    for (int j = 0; j < i; j++) {
      FBT_TRUE(status_value[i] != status_value[j]);
      FBT_TRUE(strcmp(text, fb_status_string((fb_status)status_value[j])) != 0);
    }
  }
}

/* Interface: a number that is no status still has a text, and not that of a status. */
TEST(an_unknown_status_has_a_text)
{
  const char *text = fb_status_string((fb_status)1);
  FBT_TRUE(text != NULL);
  FBT_TRUE(strlen(text) > 0);
  for (int i = 0; i < FBT_COUNT(status_value); i++) {
    FBT_TRUE(strcmp(text, status_text[i]) != 0);
  }
}

SUITE(status, RUN(every_status_has_its_own_value_and_text), RUN(an_unknown_status_has_a_text))
