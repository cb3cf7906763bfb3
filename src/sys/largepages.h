/* Memory on large pages. Private to src. */
#pragma once

extern void UseLargePages(void);
