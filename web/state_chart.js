// A chart whose scale is among the settings of the page.

import {LineChart} from './chart.js';
import {byId} from './dom.js';
import {modelFileName, page, state} from './page_state.js';

// `key`: of state.log; `file`: the end of its files' names; `axes`: the columns of these.
export function chartOf(key, id, file, axes, angle, unit = '°') {
  const changeScale = log => {
    state.log[key] = log;
    page.chartsStale = true;
  };
  return new LineChart(byId(id), {file: () => `${modelFileName()}_${file}`, axes, angle, unit, changeScale});
}
