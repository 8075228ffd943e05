// Entry of the page of studies.
import "./style.css";
import "./studies.css";
import { StudyPage } from "./studies/page";

document.documentElement.dataset.theme = localStorage.getItem("theme") ?? "dark";
void new StudyPage().start();
